// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"

namespace alidade {

/// Folders where compiled shaders may lie, first to last: ALIDADE_SHADER_DIR, then
/// ../share/alidade/shaders beside the running program.
std::vector<std::filesystem::path> shaderFolders();

/// The SPIR-V words of a shader named as its source ("composite.frag"). Error where no folder has it
/// or what lies there is no SPIR-V.
Result<std::vector<std::uint32_t>> loadShader(const std::string& name);

/// When the shader's source, or a .glsl that it may include, was last changed; the epoch where
/// this is no development build or there is no source.
std::filesystem::file_time_type shaderSourceTime(const std::string& name);

/// Compiles a shader from the source tree with glslc; the compiler's own words as error.
Result<std::vector<std::uint32_t>> compileShader(const std::string& name);

}  // namespace alidade
