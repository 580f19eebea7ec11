// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <thread>

#include "app/workspace.h"
#include "io/picture_file.h"
#include "io/reader_registry.h"

namespace alidade {

namespace {

using Picture = Result<std::shared_ptr<const ColourImage>>;

/// Where a frame's picture is.
struct Place {
  std::string path;
  std::int64_t index = -1;  // in the video; -1: a picture file
  friend bool operator==(const Place&, const Place&) = default;
};

Result<Place> placeOf(const Project& project, const Frame& frame) {
  if (!frame.video) {
    if (frame.image.path.empty()) return fail("Frame '" + frame.name + "' has no picture", project.path, "Add its picture file");
    return Place{frame.image.path};
  }
  const Video* video = project.findVideo(frame.video);
  if (!video) return fail("Frame '" + frame.name + "' belongs to a video that the project does not hold", project.path,
                          "Add the video again");
  return Place{video->source.path, frame.videoFrame};
}

}  // namespace

/// One thread owns the decoders, so that they need no lock and stay open: going on by a frame is one decode.
struct PictureCache::Impl {
  struct Entry {
    Place place;
    Picture picture;
  };

  explicit Impl(std::size_t wantedCapacity) : capacity(wantedCapacity), thread([this] { run(); }) {}

  ~Impl() {
    {
      const std::lock_guard lock(mutex);
      stop = true;
    }
    wake.notify_all();
    thread.join();
  }

  const Entry* find(const Place& place) {
    const auto it = std::find_if(recent.begin(), recent.end(), [&](const Entry& e) { return e.place == place; });
    if (it == recent.end()) return nullptr;
    // What was used last stays longest.
    std::rotate(recent.begin(), it, it + 1);
    return &recent.front();
  }

  Picture wait(const Place& place) {
    std::unique_lock lock(mutex);
    if (const Entry* found = find(place)) return found->picture;
    if (!(decoding && *decoding == place)) {
      urgent.push_back(place);
      wake.notify_all();
    }
    Picture answer = fail("");
    done.wait(lock, [&] {
      const Entry* found = find(place);
      if (found) answer = found->picture;
      return found != nullptr;
    });
    // An error is told once; the next one who asks has it tried again.
    if (!answer) std::erase_if(recent, [&](const Entry& e) { return e.place == place; });
    return answer;
  }

  void run() {
    std::unique_lock lock(mutex);
    while (true) {
      wake.wait(lock, [this] { return stop || closeSources || !urgent.empty() || !expected.empty(); });
      if (stop) return;
      if (std::exchange(closeSources, false)) sources.clear();
      std::deque<Place>& queue = urgent.empty() ? expected : urgent;
      if (queue.empty()) continue;
      const Place place = queue.front();
      queue.pop_front();
      if (find(place)) {
        done.notify_all();
        continue;
      }
      decoding = place;
      lock.unlock();
      Picture picture = decode(place);
      lock.lock();
      decoding.reset();
      recent.push_front({place, std::move(picture)});
      if (recent.size() > capacity) recent.pop_back();
      done.notify_all();
    }
  }

  Picture decode(const Place& place) {
    auto decoded = place.index < 0 ? readPicture(place.path) : decodeVideo(place);
    if (!decoded) return fail(decoded.error());
    return std::make_shared<const ColourImage>(std::move(*decoded));
  }

  Result<ColourImage> decodeVideo(const Place& place) {
    auto& source = sources[place.path];
    if (!source) {
      const auto reader = ReaderRegistry::instance().findAs<PictureReader>(place.path);
      if (!reader) return fail(reader.error());
      auto opened = (*reader)->open(place.path);
      if (!opened) return fail(opened.error());
      source = std::move(*opened);
    }
    return source->picture(static_cast<std::size_t>(place.index));
  }

  const std::size_t capacity;
  std::mutex mutex;
  std::condition_variable wake, done;
  std::deque<Entry> recent;
  std::deque<Place> urgent, expected;
  std::optional<Place> decoding;
  bool stop = false, closeSources = false;
  std::map<std::string, std::unique_ptr<PictureSource>> sources;  // the thread's own
  std::thread thread;
};

PictureCache::PictureCache(std::size_t capacity) : m_impl(std::make_unique<Impl>(std::max<std::size_t>(2, capacity))) {}

PictureCache::~PictureCache() = default;

Result<std::shared_ptr<const ColourImage>> PictureCache::picture(const Project& project, const Frame& frame) {
  const auto place = placeOf(project, frame);
  if (!place) return fail(place.error());
  return m_impl->wait(*place);
}

void PictureCache::expect(const Project& project, const std::vector<FrameId>& next) {
  const std::lock_guard lock(m_impl->mutex);
  m_impl->expected.clear();
  for (const FrameId id : next) {
    const Frame* frame = project.findFrame(id);
    // Half of what is kept: what was decoded ahead must not push out what is about to be shown.
    if (!frame || m_impl->expected.size() >= m_impl->capacity / 2) continue;
    if (const auto place = placeOf(project, *frame)) m_impl->expected.push_back(*place);
  }
  m_impl->wake.notify_all();
}

void PictureCache::clear() {
  const std::lock_guard lock(m_impl->mutex);
  m_impl->recent.clear();
  m_impl->expected.clear();
  m_impl->closeSources = true;
  m_impl->wake.notify_all();
}

}  // namespace alidade
