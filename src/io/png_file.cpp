// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include <png.h>
#include <zlib.h>

#include "io/atomic_file.h"
#include "io/picture_file.h"
#include "plugin_api/text_file.h"

namespace alidade {

namespace {

constexpr std::size_t kMaxTextBytes = std::size_t(16) << 20;

/// Everything that libpng's callbacks need; lives outside the function that setjmp returns to.
struct PngWriting {
  png_structp png = nullptr;
  png_infop info = nullptr;
  AtomicFile* file = nullptr;
  std::string problem;
  std::jmp_buf back;

  ~PngWriting() {
    if (png) png_destroy_write_struct(&png, &info);
  }
};

[[noreturn]] void onPngError(png_structp png, png_const_charp message) {
  auto* writing = static_cast<PngWriting*>(png_get_error_ptr(png));
  writing->problem = message;
  std::longjmp(writing->back, 1);
}

void onPngWarning(png_structp, png_const_charp) {}

void writeBytes(png_structp png, png_bytep data, png_size_t size) {
  auto* writing = static_cast<PngWriting*>(png_get_io_ptr(png));
  if (!writing->file->write(std::as_bytes(std::span(data, size)))) png_error(png, "write failed");
}

void flushBytes(png_structp) {}

/// Nothing here has a destructor: libpng leaves by longjmp.
bool encode(PngWriting& writing, const ColourImage& image, std::vector<png_text>& texts) {
  if (setjmp(writing.back) != 0) return false;
  png_set_write_fn(writing.png, &writing, writeBytes, flushBytes);
  png_set_IHDR(writing.png, writing.info, static_cast<png_uint_32>(image.width()), static_cast<png_uint_32>(image.height()),
               8, PNG_COLOR_TYPE_RGBA, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_compression_level(writing.png, 3);  // a tenth larger than 6, three times as fast
  if (!texts.empty()) png_set_text(writing.png, writing.info, texts.data(), static_cast<int>(texts.size()));
  png_write_info(writing.png, writing.info);
  for (int y = 0; y < image.height(); ++y)
    png_write_row(writing.png, reinterpret_cast<png_const_bytep>(image.row(y)));
  png_write_end(writing.png, writing.info);
  return true;
}

/// PNG 1.2, 4.2.3: 1 to 79 bytes of printable Latin-1, here ASCII; no space at either end or twice.
bool isKeyword(const std::string& key) {
  const bool printable = std::all_of(key.begin(), key.end(), [](char c) { return c >= 0x20 && c < 0x7f; });
  return !key.empty() && key.size() <= 79 && printable && key.front() != ' ' && key.back() != ' ' &&
         key.find("  ") == std::string::npos;
}

bool isAscii(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

Result<std::vector<png_text>> textChunks(const std::map<std::string, std::string>& text) {
  std::vector<png_text> chunks;
  for (const auto& [key, value] : text) {
    if (!isKeyword(key)) return fail("'" + key + "' is no keyword of a PNG text", {}, "Use 1 to 79 plain letters");
    if (value.find('\0') != std::string::npos) return fail("The PNG text '" + key + "' holds a zero byte", {}, "Remove it");
    png_text chunk{};
    chunk.key = const_cast<png_charp>(key.c_str());
    chunk.text = const_cast<png_charp>(value.c_str());
    if (isAscii(value)) {
      chunk.compression = PNG_TEXT_COMPRESSION_NONE;
      chunk.text_length = value.size();
    } else {  // UTF-8 goes into iTXt
      chunk.compression = PNG_ITXT_COMPRESSION_NONE;
      chunk.itxt_length = value.size();
    }
    chunks.push_back(chunk);
  }
  return chunks;
}

std::uint32_t bigEndian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

Result<std::string> inflated(std::string_view packed, const std::string& path) {
  std::string text;
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return fail("zlib cannot be started", path);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  std::array<char, 16384> block{};
  int state = Z_OK;
  while (state == Z_OK && text.size() <= kMaxTextBytes) {
    stream.next_out = reinterpret_cast<Bytef*>(block.data());
    stream.avail_out = block.size();
    state = inflate(&stream, Z_NO_FLUSH);
    text.append(block.data(), block.size() - stream.avail_out);
  }
  inflateEnd(&stream);
  if (state != Z_STREAM_END) return fail("A compressed text of the PNG is damaged or too large", path, "Copy the file again");
  return text;
}

/// Keyword and text of a tEXt, zTXt or iTXt chunk (PNG 1.2, 4.2.3).
Result<std::pair<std::string, std::string>> decodeText(std::string_view type, std::string_view data, const std::string& path) {
  const auto broken = [&] { return fail("A text chunk of the PNG is damaged", path, "Copy the file again"); };
  const std::size_t keyEnd = data.find('\0');
  if (keyEnd == std::string_view::npos) return broken();
  const std::string key(data.substr(0, keyEnd));
  std::string_view rest = data.substr(keyEnd + 1);
  bool packed = type == "zTXt";
  if (packed) {
    if (rest.empty()) return broken();
    rest.remove_prefix(1);
  } else if (type == "iTXt") {
    if (rest.size() < 2) return broken();
    packed = rest[0] != 0;
    rest.remove_prefix(2);
    for (int i = 0; i < 2; ++i) {  // language, translated keyword
      const std::size_t end = rest.find('\0');
      if (end == std::string_view::npos) return broken();
      rest.remove_prefix(end + 1);
    }
  }
  if (!packed) return std::pair(key, std::string(rest));
  auto text = inflated(rest, path);
  if (!text) return fail(text.error());
  return std::pair(key, std::move(*text));
}

}  // namespace

Result<void> writePng(const ColourImage& image, const std::string& path, const std::map<std::string, std::string>& text) {
  if (image.empty()) return fail("There is no picture to save", path, "Render it first");
  auto chunks = textChunks(text);
  if (!chunks) return fail(chunks.error().in(path));
  auto file = AtomicFile::create(path);
  if (!file) return fail(file.error());

  PngWriting writing;
  writing.file = &*file;
  writing.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &writing, onPngError, onPngWarning);
  writing.info = writing.png ? png_create_info_struct(writing.png) : nullptr;
  if (!writing.info) return fail("The PNG writer cannot be started", path, "Close other programs to free memory");
  if (!encode(writing, image, *chunks)) {
    // A failed write is told best by the file itself.
    if (auto committed = file->write({}) ? Result<void>() : file->commit(); !committed) return committed;
    return fail("The PNG cannot be written: " + writing.problem, path, "Choose a smaller picture");
  }
  return file->commit();
}

Result<std::map<std::string, std::string>> readPngText(const std::string& path) {
  const auto bytes = readTextFile(path);
  if (!bytes) return fail(bytes.error());
  std::string_view rest(*bytes);
  constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
  if (!rest.starts_with(kSignature)) return fail("The file is no PNG", path, "Choose a PNG picture");
  rest.remove_prefix(kSignature.size());

  std::map<std::string, std::string> texts;
  while (true) {
    if (rest.size() < 12 || bigEndian(rest) > rest.size() - 12)
      return fail("The PNG is cut off", path + ", offset " + std::to_string(bytes->size() - rest.size()), "Copy the file again");
    const std::uint32_t length = bigEndian(rest);
    const std::string_view type = rest.substr(4, 4), data = rest.substr(8, length);
    if (type == "IEND") return texts;
    if (type == "tEXt" || type == "zTXt" || type == "iTXt") {
      const auto checksum = crc32(0, reinterpret_cast<const Bytef*>(rest.data() + 4), length + 4);
      if (checksum != bigEndian(rest.substr(8 + length)))
        return fail("A text chunk of the PNG is damaged: its checksum is wrong", path, "Copy the file again");
      auto text = decodeText(type, data, path);
      if (!text) return fail(text.error());
      texts.insert(std::move(*text));
    }
    rest.remove_prefix(std::size_t(length) + 12);
  }
}

}  // namespace alidade
