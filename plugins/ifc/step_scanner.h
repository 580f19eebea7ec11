// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "base/error.h"

namespace alidade {

/// What a look through a STEP file's text tells, without building its entities.
struct StepSummary {
  std::string schema;                          ///< "IFC4", upper case, as FILE_SCHEMA names it
  std::string program;                         ///< originating system of FILE_NAME; may be empty
  std::map<std::string, std::uint64_t> count;  ///< entity name in upper case -> instances
  std::string crsName;                         ///< first IFCPROJECTEDCRS's name; may be empty
};

/// Reads the exchange structure's clear text (ISO 10303-21): header, then the instance names of the data
/// section. Strings and comments are skipped properly. Error where it is no STEP file, names no schema, or
/// ends before END-ISO-10303-21.
Result<StepSummary> scanStep(std::string_view text);

/// Error that says what to do, unless the schema is one that is read: IFC2X3 or IFC4.
Result<void> checkSchema(const std::string& schema);

/// Does the type stand for something that has a body and is drawn ("IFCWALL")? Upper case.
bool isDrawnProduct(std::string_view entity);

}  // namespace alidade
