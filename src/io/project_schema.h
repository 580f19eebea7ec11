// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <string_view>

namespace alidade {

/// resources/schemas/project.sql.
extern const std::string_view kProjectSchema;

/// Raise it once a release with every change of the schema. A column added since an older version keeps its member's
/// default when such a file is read.
inline constexpr std::uint32_t kProjectVersion = 6;

/// SQLite's application_id: "ALID".
inline constexpr std::uint32_t kProjectApplicationId = 0x414c4944;

}  // namespace alidade
