// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/byte_source.h"

#include <algorithm>

#include "base/input_file.h"
#include "las/http_source.h"

namespace alidade {

namespace {

class FileSource : public ByteSource {
 public:
  explicit FileSource(InputFile file) : ByteSource(file.path(), file.size()), m_file(std::move(file)) {}
  Result<void> readAt(std::uint64_t offset, std::span<std::byte> into) const override {
    return m_file.readAt(offset, into);
  }

 private:
  InputFile m_file;
};

}  // namespace

Result<std::size_t> ByteSource::readSome(std::uint64_t offset, std::span<std::byte> into) const {
  const std::size_t count = offset < size() ? std::min<std::uint64_t>(into.size(), size() - offset) : 0;
  if (auto ok = readAt(offset, into.first(count)); !ok) return fail(ok.error());
  return count;
}

bool isWebAddress(const std::string& path) {
  return path.starts_with("http://") || path.starts_with("https://");
}

Result<std::shared_ptr<const ByteSource>> ByteSource::open(const std::string& path) {
  if (isWebAddress(path)) return openHttpSource(path);
  auto file = InputFile::open(path);
  if (!file) return fail(file.error());
  return std::make_shared<const FileSource>(std::move(*file));
}

}  // namespace alidade
