// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pictures/mp4_times.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace alidade {

namespace {

constexpr std::uint64_t kMostMovieBytes = std::uint64_t(256) << 20;  // an hour at 60 Hz has 3 MB of tables
constexpr std::size_t kMostFrames = std::size_t(1) << 26;
constexpr int kMostTracks = 64;

using Bytes = std::span<const std::byte>;

std::uint64_t number(Bytes bytes, std::size_t at, int width) {
  std::uint64_t value = 0;
  for (int i = 0; i < width; ++i) value = value << 8 | std::to_integer<std::uint64_t>(bytes[at + static_cast<std::size_t>(i)]);
  return value;
}

/// The box at the head of `bytes`: its type, header length and whole length. Nothing where it does not fit.
struct Box {
  std::uint32_t type = 0;
  std::uint64_t header = 0, size = 0;
};

std::optional<Box> boxAt(Bytes head, std::uint64_t room) {
  if (head.size() < 8) return std::nullopt;
  Box box{static_cast<std::uint32_t>(number(head, 4, 4)), 8, number(head, 0, 4)};
  if (box.size == 1) {
    if (head.size() < 16) return std::nullopt;
    box.header = 16;
    box.size = number(head, 8, 8);
  } else if (box.size == 0) {
    box.size = room;  // to the end of the file
  }
  if (box.size < box.header || box.size > room) return std::nullopt;
  return box;
}

constexpr std::uint32_t code(const char (&name)[5]) {
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(name[i]);
  return value;
}

/// Contents of the first box of that type among `boxes`; empty where there is none.
Bytes child(Bytes boxes, std::uint32_t type, int skip = 0) {
  while (const auto box = boxAt(boxes, boxes.size())) {
    if (box->type == type && skip-- == 0) return boxes.subspan(box->header, box->size - box->header);
    boxes = boxes.subspan(box->size);
  }
  return {};
}

/// A full box's table: version, entry count, entries of `width` bytes.
struct Table {
  int version = 0;
  std::size_t count = 0;
  Bytes entries;
};

std::optional<Table> tableOf(Bytes box, std::size_t width) {
  if (box.size() < 8) return std::nullopt;
  Table table{static_cast<int>(number(box, 0, 1)), static_cast<std::size_t>(number(box, 4, 4)), box.subspan(8)};
  if (table.count > table.entries.size() / width) return std::nullopt;
  return table;
}

/// What edits keep: media time of the first frame shown; nothing where they repeat or cut.
std::optional<std::int64_t> shownFrom(Bytes track, std::int64_t mediaEnd, double mediaPerMovie) {
  const Bytes list = child(child(track, code("edts")), code("elst"));
  if (list.empty()) return 0;
  const int width = number(list, 0, 1) == 1 ? 8 : 4;
  const std::size_t entryBytes = static_cast<std::size_t>(2 * width + 4);
  const auto table = tableOf(list, entryBytes);
  if (!table) return std::nullopt;
  std::optional<std::int64_t> start;
  for (std::size_t i = 0; i < table->count; ++i) {
    const std::size_t at = i * entryBytes;
    const std::uint64_t stored = number(table->entries, at + static_cast<std::size_t>(width), width);
    const std::int64_t mediaTime = width == 8 ? static_cast<std::int64_t>(stored) : static_cast<std::int32_t>(stored);
    if (mediaTime < 0) continue;  // an empty edit delays all frames alike
    if (start || mediaTime > mediaEnd) return std::nullopt;
    start = mediaTime;
    const double duration = static_cast<double>(number(table->entries, at, width)) * mediaPerMovie;
    // A frame's duration of slack: writers round.
    if (duration > 0 && duration + 2 * mediaPerMovie < 0.98 * static_cast<double>(mediaEnd - mediaTime)) return std::nullopt;
  }
  return start;
}

Error lie(const InputFile& file, const std::string& what) {
  return {"The video's index is damaged: " + what, file.path(), "Copy the file again"};
}

Result<std::optional<std::vector<double>>> timesOfTrack(const InputFile& file, Bytes track, double movieScale) {
  const Bytes media = child(track, code("mdia")), header = child(media, code("mdhd"));
  const std::size_t scaleAt = !header.empty() && number(header, 0, 1) == 1 ? 20 : 12;
  if (header.size() < scaleAt + 4) return fail(lie(file, "the track has no time scale"));
  const auto scale = static_cast<double>(number(header, scaleAt, 4));
  if (scale <= 0) return fail(lie(file, "its time scale is 0"));
  const Bytes samples = child(child(media, code("minf")), code("stbl"));

  const auto durations = tableOf(child(samples, code("stts")), 8);
  if (!durations) return fail(lie(file, "its table of times (stts) is cut off"));
  std::vector<std::int64_t> shown;
  std::int64_t decoded = 0;
  for (std::size_t i = 0; i < durations->count; ++i) {
    const auto run = static_cast<std::size_t>(number(durations->entries, 8 * i, 4));
    const auto step = static_cast<std::int64_t>(number(durations->entries, 8 * i + 4, 4));
    // A frame has a place in the file: runs that promise more than its bytes are no frames.
    if (run > kMostFrames - shown.size() || shown.size() + run > file.size())
      return fail(lie(file, "it promises more frames than the file can hold"));
    for (std::size_t k = 0; k < run; ++k, decoded += step) shown.push_back(decoded);
  }
  const Bytes sizes = child(samples, code("stsz"));
  if (sizes.size() >= 12 && number(sizes, 8, 4) != shown.size())
    return fail(lie(file, "it gives times to " + std::to_string(shown.size()) + " frames, but sizes to " +
                              std::to_string(number(sizes, 8, 4))));
  if (shown.empty()) return std::vector<double>();

  if (const Bytes box = child(samples, code("ctts")); !box.empty()) {
    const auto offsets = tableOf(box, 8);
    if (!offsets) return fail(lie(file, "its table of picture order (ctts) is cut off"));
    std::size_t at = 0;
    for (std::size_t i = 0; i < offsets->count; ++i) {
      const std::uint64_t run = number(offsets->entries, 8 * i, 4);
      // Version 0 has no negative ones by the letter, writers have them all the same.
      const auto offset = static_cast<std::int32_t>(number(offsets->entries, 8 * i + 4, 4));
      if (run > shown.size() - at) return fail(lie(file, "its table of picture order (ctts) is too long"));
      for (std::uint64_t k = 0; k < run; ++k) shown[at++] += offset;
    }
  }
  std::sort(shown.begin(), shown.end());
  const auto start = shownFrom(track, shown.back(), movieScale > 0 ? scale / movieScale : 0);
  if (!start || *start > shown.front()) return std::optional<std::vector<double>>();
  std::vector<double> times(shown.size());
  for (std::size_t i = 0; i < shown.size(); ++i) times[i] = static_cast<double>(shown[i] - shown.front()) / scale;
  return times;
}

/// The contents of moov; empty where there is none or the file is in fragments.
Result<std::vector<std::byte>> movieOf(const InputFile& file) {
  std::vector<std::byte> movie;
  std::uint64_t at = 0;
  while (at + 8 <= file.size()) {
    std::array<std::byte, 16> head{};
    const auto count = file.readSome(at, head);
    if (!count) return fail(count.error());
    const auto box = boxAt(Bytes(head).first(*count), file.size() - at);
    if (!box) break;  // cut off: what stands before it may do
    if (box->type == code("moof")) return std::vector<std::byte>();
    if (box->type == code("moov") && movie.empty()) {
      if (box->size > kMostMovieBytes) return fail(lie(file, "it is larger than 256 MiB"));
      movie.resize(static_cast<std::size_t>(box->size - box->header));
      if (auto read = file.readAt(at + box->header, movie); !read) return fail(read.error());
    }
    at += box->size;
  }
  return movie;
}

}  // namespace

Result<std::optional<std::vector<double>>> mp4FrameTimes(const InputFile& file) {
  const auto movie = movieOf(file);
  if (!movie) return fail(movie.error());
  if (movie->empty() || !child(*movie, code("mvex")).empty()) return std::optional<std::vector<double>>();
  const Bytes header = child(*movie, code("mvhd"));
  const std::size_t scaleAt = !header.empty() && number(header, 0, 1) == 1 ? 20 : 12;
  const double movieScale = header.size() >= scaleAt + 4 ? static_cast<double>(number(header, scaleAt, 4)) : 0;
  for (int i = 0; i < kMostTracks; ++i) {
    const Bytes track = child(*movie, code("trak"), i);
    if (track.empty()) break;
    const Bytes handler = child(child(track, code("mdia")), code("hdlr"));
    if (handler.size() >= 12 && number(handler, 8, 4) == code("vide")) return timesOfTrack(file, track, movieScale);
  }
  return std::optional<std::vector<double>>();
}

}  // namespace alidade
