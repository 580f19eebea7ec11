// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "base/input_file.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace alidade {

Result<InputFile> InputFile::open(const std::string& path) {
  InputFile file;
  file.m_path = path;
  // O_NONBLOCK: a named pipe must not hang the open; it is refused below.
  file.m_descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file.m_descriptor < 0)
    return fail(std::string("The file cannot be opened: ") + std::strerror(errno), path,
                "Check that it exists and may be read");
  struct stat status{};
  if (::fstat(file.m_descriptor, &status) != 0)
    return fail(std::string("The file cannot be examined: ") + std::strerror(errno), path);
  if (!S_ISREG(status.st_mode))
    return fail(S_ISDIR(status.st_mode) ? "This is a folder, not a file" : "This is not a regular file", path,
                "Choose the file itself");
  file.m_size = static_cast<std::uint64_t>(status.st_size);
  return file;
}

InputFile::InputFile(InputFile&& other) noexcept
    : m_path(std::move(other.m_path)), m_size(other.m_size), m_descriptor(std::exchange(other.m_descriptor, -1)) {}

InputFile& InputFile::operator=(InputFile&& other) noexcept {
  std::swap(m_path, other.m_path);
  std::swap(m_size, other.m_size);
  std::swap(m_descriptor, other.m_descriptor);
  return *this;
}

InputFile::~InputFile() {
  if (m_descriptor >= 0) ::close(m_descriptor);
}

Result<void> InputFile::readAt(std::uint64_t offset, std::span<std::byte> into) const {
  const auto got = readSome(offset, into);
  if (!got) return fail(got.error());
  if (*got < into.size())
    return fail("The file ends in the middle of what should be read",
                m_path + ", offset " + std::to_string(offset + *got), "It may be truncated: copy or export it again");
  return {};
}

Result<std::size_t> InputFile::readSome(std::uint64_t offset, std::span<std::byte> into) const {
  std::size_t done = 0;
  while (done < into.size()) {
    const std::uint64_t at = offset + done;
    if (at < offset || at > static_cast<std::uint64_t>(INT64_MAX)) break;
    const ssize_t got = ::pread(m_descriptor, into.data() + done, into.size() - done, static_cast<off_t>(at));
    if (got < 0) {
      if (errno == EINTR) continue;
      return fail(std::string("The file cannot be read: ") + std::strerror(errno),
                  m_path + ", offset " + std::to_string(at));
    }
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

}  // namespace alidade
