// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "survey/design_model.h"

namespace alidade {

/// A remark on a conversion: what was tolerated or left out, and where.
struct ConversionNote {
  std::string what;
  std::string where;
};

/// A design on its way between two programs: a converter writes it, the reader trusts none of it.
struct DesignStream {
  DesignModel model;
  std::vector<ConversionNote> notes;
};

/// Little-endian bytes: "ALDS", version, the model's header, its arrays with their counts, the elements,
/// the notes. Only for handing over between programs of one build, never for files.
std::vector<std::byte> encodeDesign(const DesignStream& design);

/// Checks everything that a later step relies on: counts against the bytes that are there, finite
/// coordinates, indices within range, element ranges that neither overlap nor leave the arrays.
Result<DesignStream> decodeDesign(std::span<const std::byte> bytes);

}  // namespace alidade
