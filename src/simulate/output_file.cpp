// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulate/output_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

namespace alidade {

namespace {

std::string adviceFor(int code) {
  if (code == ENOSPC || code == EDQUOT) return "Free some space on the disk or choose another folder";
  if (code == EACCES || code == EPERM || code == EROFS) return "Choose a folder that you may write to";
  return "Check the disk and choose another folder";
}

}  // namespace

OutputFile::~OutputFile() {
  if (!m_file) return;
  std::fclose(m_file);
  std::error_code ignored;
  std::filesystem::remove(m_path, ignored);
}

Result<void> OutputFile::failed(const char* doing) const {
  const int code = errno;
  return fail(fmt::format("{}: {}", doing, std::strerror(code)), m_path, adviceFor(code));
}

Result<void> OutputFile::open(const std::string& path) {
  m_path = path;
  m_file = std::fopen(path.c_str(), "wb");
  if (!m_file) return failed("The file cannot be created");
  return {};
}

Result<void> OutputFile::write(const void* data, std::size_t size) {
  if (std::fwrite(data, 1, size, m_file) != size) return failed("The file cannot be written");
  return {};
}

Result<void> OutputFile::patch(std::uint64_t offset, const void* data, std::size_t size) {
  if (fseeko(m_file, static_cast<off_t>(offset), SEEK_SET) != 0) return failed("The file cannot be written");
  if (const auto written = write(data, size); !written) return written;
  if (fseeko(m_file, 0, SEEK_END) != 0) return failed("The file cannot be written");
  return {};
}

Result<void> OutputFile::finish() {
  const bool flushed = std::fflush(m_file) == 0;
  const Result<void> outcome = flushed ? Result<void>{} : failed("The file cannot be written");
  if (!flushed) return outcome;
  std::FILE* file = m_file;
  m_file = nullptr;
  if (std::fclose(file) != 0) return failed("The file cannot be written");
  return {};
}

Result<void> writeWholeFile(const std::string& path, std::string_view content) {
  OutputFile file;
  if (auto opened = file.open(path); !opened) return opened;
  if (auto written = file.write(content); !written) return written;
  return file.finish();
}

Result<void> makeFolder(const std::string& path) {
  std::error_code code;
  std::filesystem::create_directories(path, code);
  if (code)
    return fail(fmt::format("The folder cannot be made: {}", code.message()), path, adviceFor(code.value()));
  return {};
}

}  // namespace alidade
