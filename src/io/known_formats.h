// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>

#include "base/error.h"
#include "plugin_api/reader.h"

namespace alidade {

/// The refusal of a file whose format is known but not read: it names the format and says which
/// program turns it into one that is. Empty where the format is not recognised. Ask it only after
/// every reader has declined, so that a plugin that reads the format wins.
std::optional<Error> refusalOfKnownFormat(const FileProbe& probe);

}  // namespace alidade
