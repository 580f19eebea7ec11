// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/frame_times.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>

#include <fmt/format.h>

#include "app/pose_clock.h"
#include "plugin_api/text_file.h"

namespace alidade {

namespace {

constexpr std::uint64_t kMostTableBytes = std::uint64_t(256) << 20;

/// Seconds; whole numbers of more digits than any clock counts seconds with are nanoseconds.
std::optional<double> secondsOf(std::string_view word) {
  if (const auto whole = parseInteger(word); whole && std::abs(static_cast<double>(*whole)) > 1e14)
    return static_cast<double>(*whole / 1'000'000'000) + static_cast<double>(*whole % 1'000'000'000) * 1e-9;
  const auto number = parseNumber(word);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

std::vector<std::string_view> wordsOf(std::string_view line) {
  std::vector<std::string_view> words;
  if (line.find(',') == std::string_view::npos && line.find(';') == std::string_view::npos) {
    FieldReader fields(line);
    for (std::string_view word; fields.next(word);) words.push_back(word);
    return words;
  }
  while (true) {
    const std::size_t comma = line.find_first_of(",;");
    words.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return words;
    line.remove_prefix(comma + 1);
  }
}

std::vector<std::size_t> framesOf(const Project& project, VideoId video) {
  std::vector<std::size_t> frames;
  for (std::size_t i = 0; i < project.frames.size(); ++i)
    if (project.frames[i].video == video) frames.push_back(i);
  std::stable_sort(frames.begin(), frames.end(), [&](std::size_t a, std::size_t b) {
    return project.frames[a].videoFrame < project.frames[b].videoFrame;
  });
  return frames;
}

std::string stemOf(const std::string& name) { return name.substr(0, name.rfind('.')); }

/// Sets times by frame and everything that hangs on them.
void apply(Project& project, VideoId id, const std::vector<std::size_t>& frames, const std::vector<double>& secs, FrameTiming timing) {
  std::set<TrajectoryId> moved;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    project.frames[frames[i]].timeSecs = secs[i];
    moved.insert(project.frames[frames[i]].trajectory);
  }
  for (Video& video : project.videos) {
    if (video.id != id) continue;
    video.timing = timing;
    if (secs.size() > 1) video.framesPerSecond = static_cast<double>(secs.size() - 1) / (secs.back() - secs.front());
  }
  for (const TrajectoryId trajectory : moved)
    if (trajectory) poseFromTrajectory(project, trajectory);
  std::stable_sort(project.frames.begin(), project.frames.end(),
                   [](const Frame& a, const Frame& b) { return a.timeSecs < b.timeSecs; });
}

}  // namespace

Result<std::vector<FrameTime>> readFrameTimes(const std::string& path) {
  const auto text = readTextFile(path, kMostTableBytes);
  if (!text) return fail(text.error());
  std::vector<FrameTime> times;
  LineReader lines(*text);
  bool maybeHeader = true;
  for (std::string_view line; lines.next(line);) {
    const std::string_view content = trimmed(line);
    if (content.empty() || content.starts_with('#')) continue;
    const auto words = wordsOf(content);
    FrameTime time;
    time.where = placeInFile(path, lines.number());
    const auto first = secondsOf(words[0]), second = words.size() > 1 ? secondsOf(words[1]) : std::nullopt;
    const bool header = maybeHeader && !first && !second;
    maybeHeader = false;
    if (header) continue;
    if (words.size() > 2 || !(first || second))
      return fail("The line is no time: '" + quotedWords(content) + "'", time.where, "Give a time, or a picture's name and a time, a line");
    // "frame,time" with both numbers: the frame's number comes first.
    if (second) time.secs = *second, time.name = std::string(words[0]);
    else time.secs = *first, time.name = words.size() > 1 ? std::string(words[1]) : std::string();
    times.push_back(std::move(time));
  }
  if (times.empty()) return fail("The table holds no time", path, "Give a time, or a picture's name and a time, a line");
  return times;
}

Result<void> setFrameTimes(Project& project, VideoId video, const std::vector<FrameTime>& times) {
  const std::vector<std::size_t> frames = framesOf(project, video);
  if (frames.empty()) return fail("There are no frames to give times to", project.path, "Add the video or the pictures first");
  std::vector<double> secs;
  if (std::any_of(times.begin(), times.end(), [](const FrameTime& t) { return !t.name.empty(); })) {
    std::unordered_map<std::string, double> byName;
    for (const FrameTime& time : times)
      if (!byName.emplace(stemOf(time.name), time.secs).second)
        return fail("Frame '" + time.name + "' has two times", time.where, "Keep one line a frame");
    for (const std::size_t i : frames) {
      const Frame& frame = project.frames[i];
      auto found = byName.find(stemOf(frame.name));
      if (found == byName.end() && frame.video) found = byName.find(std::to_string(frame.videoFrame));
      if (found == byName.end()) return fail("The table has no time for frame '" + frame.name + "'", times.front().where, "Name every frame");
      secs.push_back(found->second);
    }
  } else if (times.size() != frames.size()) {
    return fail(fmt::format("The table has {} times for {} frames", times.size(), frames.size()), times.front().where,
                "Give one time a frame, or name the frames");
  } else {
    for (const FrameTime& time : times) secs.push_back(time.secs);
  }
  for (std::size_t i = 1; i < secs.size(); ++i)
    if (!(secs[i] > secs[i - 1]))
      return fail(fmt::format("Frame '{}' is not later than the one before it ({} s after {} s)", project.frames[frames[i]].name,
                              secs[i], secs[i - 1]),
                  times.front().where, "Sort the table by the frames, and mend the times");
  apply(project, video, frames, secs, FrameTiming::Table);
  return {};
}

Result<void> setFrameRate(Project& project, VideoId video, double framesPerSecond, double startSecs) {
  if (!(framesPerSecond > 0 && framesPerSecond <= 1e5) || !std::isfinite(startSecs))
    return fail("The frame rate makes no sense", project.path, "Give frames a second, up to 100 000");
  const std::vector<std::size_t> frames = framesOf(project, video);
  if (frames.empty()) return fail("There are no frames to give times to", project.path, "Add the video or the pictures first");
  std::vector<double> secs(frames.size());
  for (std::size_t i = 0; i < secs.size(); ++i) secs[i] = startSecs + static_cast<double>(i) / framesPerSecond;
  apply(project, video, frames, secs, FrameTiming::ConstantRate);
  return {};
}

std::ptrdiff_t firstFallingTime(const Project& project, VideoId video) {
  const std::vector<std::size_t> frames = framesOf(project, video);
  for (std::size_t i = 1; i < frames.size(); ++i)
    if (!(project.frames[frames[i]].timeSecs > project.frames[frames[i - 1]].timeSecs)) return static_cast<std::ptrdiff_t>(frames[i]);
  return -1;
}

}  // namespace alidade
