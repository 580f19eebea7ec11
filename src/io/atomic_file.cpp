// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/atomic_file.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace alidade {

namespace fs = std::filesystem;

namespace {

Error writeError(int code, const std::string& path) {
  const std::string reason = std::strerror(code);
  switch (code) {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return {"There is no room to save the file: " + reason, path, "Free some space or choose another disk"};
    case EACCES:
    case EPERM:
    case EROFS:
      return {"The file may not be written: " + reason, path, "Choose another folder or ask for permission"};
    case ENOENT:
    case ENOTDIR:
      return {"The folder does not exist", path, "Make the folder first or choose another"};
    case EISDIR:
      return {"This is a folder, not a file", path, "Give a file name"};
    default:
      return {"The file cannot be saved: " + reason, path, "Choose another place"};
  }
}

}  // namespace

Result<AtomicFile> AtomicFile::create(const std::string& path) {
  AtomicFile file;
  file.m_asked = path;
  if (path.empty()) return fail("No file is named", {}, "Give a file name");
  std::error_code error;
  const fs::path followed = fs::weakly_canonical(path, error);
  file.m_target = error ? fs::absolute(path).string() : followed.string();

  struct stat status {};
  const bool exists = ::stat(file.m_target.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) return fail(writeError(EISDIR, path));
  if (exists && !S_ISREG(status.st_mode)) {
    file.m_direct = true;
    file.m_temporary = file.m_target;
    file.m_descriptor = ::open(file.m_target.c_str(), O_WRONLY | O_CLOEXEC);
    if (file.m_descriptor < 0) return fail(writeError(errno, path));
    return file;
  }
  // Rename asks nothing of the old file itself: a file that was made read-only stays as it is.
  if (exists && ::access(file.m_target.c_str(), W_OK) != 0) return fail(writeError(errno, path));

  const fs::path target(file.m_target);
  const std::string name = target.filename().string();
  // NAME_MAX leaves a long name no room for the dot and the ending.
  std::string pattern = (target.parent_path() / fmt::format(".{}.saving-XXXXXX", name.size() < 230 ? name : "alidade")).string();
  file.m_descriptor = ::mkostemp(pattern.data(), O_CLOEXEC);
  if (file.m_descriptor < 0) return fail(writeError(errno, path));
  file.m_temporary = pattern;

  // mkstemp's 0600 is meant for secrets: keep the old file's mode, or what a plain open would give.
  const mode_t mask = ::umask(0);
  ::umask(mask);
  ::fchmod(file.m_descriptor, exists ? status.st_mode & 07777 : 0666 & ~mask);
  return file;
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : m_asked(std::move(other.m_asked)),
      m_target(std::move(other.m_target)),
      m_temporary(std::move(other.m_temporary)),
      m_descriptor(std::exchange(other.m_descriptor, -1)),
      m_error(other.m_error),
      m_direct(other.m_direct) {
  other.m_temporary.clear();
}

AtomicFile::~AtomicFile() {
  if (m_descriptor >= 0) ::close(m_descriptor);
  if (!m_temporary.empty() && !m_direct) ::unlink(m_temporary.c_str());
}

bool AtomicFile::write(std::span<const std::byte> bytes) {
  while (m_error == 0 && !bytes.empty()) {
    const ssize_t count = ::write(m_descriptor, bytes.data(), bytes.size());
    if (count > 0) bytes = bytes.subspan(static_cast<std::size_t>(count));
    else if (count < 0 && errno != EINTR) m_error = errno;
  }
  return m_error == 0;
}

Result<void> AtomicFile::commit() {
  if (m_error == 0 && !m_direct && ::fsync(m_descriptor) != 0) m_error = errno;
  if (::close(std::exchange(m_descriptor, -1)) != 0 && m_error == 0) m_error = errno;
  if (m_error == 0 && !m_direct && ::rename(m_temporary.c_str(), m_target.c_str()) != 0) m_error = errno;
  if (m_error != 0) return fail(writeError(m_error, m_asked));
  if (m_direct) return {};
  m_temporary.clear();
  // The name is on the disk only once its folder is; a file system that cannot is no failure.
  const int folder = ::open(fs::path(m_target).parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    ::fsync(folder);
    ::close(folder);
  }
  return {};
}

}  // namespace alidade
