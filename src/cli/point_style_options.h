// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>

#include <CLI/CLI.hpp>

#include "base/error.h"
#include "survey/point_style.h"

namespace alidade::cli {

/// Options of the command line that change how points look and which are used. What is not given
/// stays as the project has it.
class PointStyleOptions {
 public:
  explicit PointStyleOptions(CLI::App& command);

  Result<void> apply(PointStyle& style) const;

 private:
  struct Given;
  std::shared_ptr<Given> m_given;
};

}  // namespace alidade::cli
