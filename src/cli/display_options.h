// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>

#include <CLI/CLI.hpp>

#include "base/error.h"
#include "cli/point_style_options.h"
#include "survey/display_settings.h"

namespace alidade::cli {

/// Options of the command line that change what of a frame is drawn, and how: all that the window's toolbar and its
/// panels "Display" and "Points" set. What is not given stays as the project has it.
class DisplayOptions {
 public:
  explicit DisplayOptions(CLI::App& command);

  Result<void> apply(DisplaySettings& display) const;

 private:
  struct Given;
  PointStyleOptions m_points;
  std::shared_ptr<Given> m_given;
};

}  // namespace alidade::cli
