// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/las_output_file.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

namespace alidade {

namespace {

tl::unexpected<Error> failed(const char* doing, const std::string& path) {
  return fail(fmt::format("The file cannot be {}: {}", doing, std::strerror(errno)), path,
              "Check the folder's permissions and the room on the disk");
}

}  // namespace

Result<LasOutputFile> LasOutputFile::create(const std::string& path) {
  LasOutputFile file;
  file.m_path = path;
  file.m_temporary = fmt::format("{}.{}.part", path, ::getpid());
  file.m_descriptor = ::open(file.m_temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file.m_descriptor < 0) return failed("made", path);
  return file;
}

LasOutputFile::LasOutputFile(LasOutputFile&& other) noexcept
    : m_path(std::move(other.m_path)),
      m_temporary(std::move(other.m_temporary)),
      m_descriptor(std::exchange(other.m_descriptor, -1)),
      m_position(other.m_position) {}

LasOutputFile::~LasOutputFile() {
  if (m_descriptor < 0) return;
  ::close(m_descriptor);
  ::unlink(m_temporary.c_str());
}

Result<void> LasOutputFile::put(std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::pwrite(m_descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return failed("written", m_path);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    offset += static_cast<std::uint64_t>(count);
  }
  return {};
}

Result<void> LasOutputFile::write(std::span<const std::byte> bytes) {
  if (auto ok = put(m_position, bytes); !ok) return ok;
  m_position += bytes.size();
  return {};
}

Result<void> LasOutputFile::patch(std::uint64_t offset, std::span<const std::byte> bytes) {
  return put(offset, bytes);
}

Result<void> LasOutputFile::commit() {
  if (::fsync(m_descriptor) != 0) return failed("written", m_path);
  const int descriptor = std::exchange(m_descriptor, -1);
  const bool closed = ::close(descriptor) == 0;
  if (closed && ::rename(m_temporary.c_str(), m_path.c_str()) == 0) return {};
  const int error = errno;
  ::unlink(m_temporary.c_str());
  errno = error;
  return failed("finished", m_path);
}

}  // namespace alidade
