// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/disk.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

namespace alidade {

Error diskError(int code, const std::string& path) {
  const std::string reason = std::strerror(code);
  switch (code) {
    case ENOSPC:
    case EDQUOT:
    case EFBIG: return {"There is no room to write the point store: " + reason, path, "Free some space or choose another disk"};
    case EACCES:
    case EPERM:
    case EROFS: return {"The point store may not be written here: " + reason, path, "Choose another folder or ask for permission"};
    case ENOENT:
    case ENOTDIR: return {"The folder does not exist", path, "Make the folder first or choose another"};
    case EIO: return {"The disk failed: " + reason, path, "Check the disk and choose another one"};
    default: return {"The point store's file cannot be used: " + reason, path, "Choose another place"};
  }
}

Result<void> writeAt(int file, std::uint64_t offset, std::span<const std::byte> bytes, const std::string& path) {
  while (!bytes.empty()) {
    const ssize_t count = ::pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return fail(diskError(count < 0 ? errno : EIO, path));
    offset += static_cast<std::uint64_t>(count);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return {};
}

Result<void> readAt(int file, std::uint64_t offset, std::span<std::byte> into, const std::string& path) {
  while (!into.empty()) {
    const ssize_t count = ::pread(file, into.data(), into.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return fail(diskError(errno, path));
    if (count == 0) return fail("The temporary file is shorter than it was written", path, "Start again with another disk");
    offset += static_cast<std::uint64_t>(count);
    into = into.subspan(static_cast<std::size_t>(count));
  }
  return {};
}

Result<void> syncFolder(const std::string& path) {
  const int folder = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return fail(diskError(errno, path));
  ::fsync(folder);  // a file system that cannot is no failure
  ::close(folder);
  return {};
}

Result<void> replaceFile(const std::string& path, std::span<const std::byte> bytes) {
  const std::string beside = path + ".new";
  const int file = ::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) return fail(diskError(errno, beside));
  auto written = writeAt(file, 0, bytes, beside);
  int code = 0;
  if (written && ::fsync(file) != 0) code = errno;
  if (::close(file) != 0 && code == 0) code = errno;
  if (written && code == 0 && ::rename(beside.c_str(), path.c_str()) != 0) code = errno;
  if (written && code == 0) return syncFolder(std::filesystem::path(path).parent_path().string());
  ::unlink(beside.c_str());
  if (!written) return written;
  return fail(diskError(code, path));
}

Result<MappedFile> MappedFile::open(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0)
    return fail(fmt::format("A file of the point store cannot be opened: {}", std::strerror(errno)), path, "Index the scans again");
  struct stat status {};
  MappedFile mapped;
  const bool regular = ::fstat(file, &status) == 0 && S_ISREG(status.st_mode);
  if (regular && status.st_size > 0) {
    void* data = ::mmap(nullptr, static_cast<std::size_t>(status.st_size), PROT_READ, MAP_SHARED, file, 0);
    if (data != MAP_FAILED) {
      mapped.m_data = static_cast<std::byte*>(data);
      mapped.m_size = static_cast<std::size_t>(status.st_size);
    }
  }
  ::close(file);
  if (!regular) return fail("A part of the point store is not a regular file", path, "Index the scans again");
  if (status.st_size > 0 && mapped.m_data == nullptr) return fail("A file of the point store cannot be mapped into memory", path);
  return mapped;
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : m_data(std::exchange(other.m_data, nullptr)), m_size(std::exchange(other.m_size, 0)) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(m_data, other.m_data);
  std::swap(m_size, other.m_size);
  return *this;
}

MappedFile::~MappedFile() {
  if (m_data != nullptr) ::munmap(m_data, m_size);
}

}  // namespace alidade
