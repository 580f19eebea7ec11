// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// The index of an MP4 file: when each frame is shown. What is decoded is the affair of FFmpeg's own fuzzers.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

#include "pictures/mp4_times.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const int descriptor = ::memfd_create("fuzz", 0);
  if (descriptor < 0 || ::write(descriptor, data, size) != static_cast<ssize_t>(size)) std::abort();
  const auto file = alidade::InputFile::open("/proc/self/fd/" + std::to_string(descriptor));
  if (!file) std::abort();
  const auto times = alidade::mp4FrameTimes(*file);
  ::close(descriptor);
  if (!times) {
    if (times.error().what.empty()) std::abort();
    return 0;
  }
  if (!*times) return 0;
  // A frame is a byte at least; times start at the first frame and never fall.
  if ((*times)->size() > size) std::abort();
  double before = 0;
  for (const double time : **times) {
    if (!std::isfinite(time) || !(time >= before)) std::abort();
    before = time;
  }
  if (!(*times)->empty() && (*times)->front() != 0) std::abort();
  return 0;
}
