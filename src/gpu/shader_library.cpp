// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "gpu/shader_library.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>

#include <unistd.h>

namespace alidade {

namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t kSpirvMagic = 0x07230203;

Result<std::vector<std::uint32_t>> readSpirv(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  std::vector<std::uint32_t> words(bytes.size() / 4);
  std::memcpy(words.data(), bytes.data(), words.size() * 4);
  if (words.size() < 5 || bytes.size() % 4 != 0 || words[0] != kSpirvMagic)
    return fail("The compiled shader is damaged", path.string(), "Install the program again");
  return words;
}

#ifdef ALIDADE_SHADER_SOURCE_DIR
fs::path sourceFolder() {
  return ALIDADE_SHADER_SOURCE_DIR;
}
#else
fs::path sourceFolder() {
  return {};
}
#endif

}  // namespace

std::vector<fs::path> shaderFolders() {
  std::vector<fs::path> folders;
  if (const char* folder = std::getenv("ALIDADE_SHADER_DIR"); folder && *folder) folders.emplace_back(folder);
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) folders.push_back(program.parent_path().parent_path() / "share/alidade/shaders");
  return folders;
}

Result<std::vector<std::uint32_t>> loadShader(const std::string& name) {
  std::string tried;
  for (const fs::path& folder : shaderFolders()) {
    const fs::path path = folder / (name + ".spv");
    std::error_code error;
    if (fs::is_regular_file(path, error)) return readSpirv(path);
    tried += (tried.empty() ? "" : ", ") + path.string();
  }
  return fail("The shader " + name + " is missing", tried,
              "Install the program again, or set ALIDADE_SHADER_DIR to the folder with its .spv files");
}

fs::file_time_type shaderSourceTime(const std::string& name) {
  fs::file_time_type newest{};
  const fs::path folder = sourceFolder();
  if (folder.empty()) return newest;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().filename() != name && entry.path().extension() != ".glsl") continue;
    const auto time = entry.last_write_time(error);
    if (!error) newest = std::max(newest, time);
  }
  return newest;
}

Result<std::vector<std::uint32_t>> compileShader(const std::string& name) {
  const fs::path folder = sourceFolder();
  const fs::path out =
      fs::temp_directory_path() / ("alidade-" + std::to_string(getpid()) + "-" + name + ".spv");
  const std::string command = "glslc --target-env=vulkan1.3 -O -I '" + folder.string() + "' -o '" +
                              out.string() + "' '" + (folder / name).string() + "' 2>&1";
  std::FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return fail("The shader compiler cannot be started", "glslc", "Install the package glslc");
  std::string words;
  std::array<char, 512> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    words.append(buffer.data(), count);
  if (pclose(pipe) != 0)
    return fail("The shader " + name + " does not compile", words, "The last good one is kept");
  auto spirv = readSpirv(out);
  std::error_code error;
  fs::remove(out, error);
  return spirv;
}

}  // namespace alidade
