// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <pugixml.hpp>

#include "e57/e57_document.h"

namespace alidade {

/// One element of images2D. Error where its numbers are none; what it is without is left at its default.
Result<E57Image> e57ImageOf(const pugi::xml_node& node, std::size_t index);

}  // namespace alidade
