// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/progress.h"

namespace alidade {

/// Libraries that crash, hang or eat memory on bad files run in a helper program of their own.
///
/// The helper gets the file's path as its last argument and one pipe (descriptor `ChildReporter::kDescriptor`)
/// that carries messages back: a kind byte, the payload's length as 32 bits little-endian, the payload.
///
///     'P'  progress: fraction as text, a blank, what is being done
///     'E'  failure: what, where and advice, each ended by a zero byte
///     'R'  a piece of the result; the pieces are joined in order
///     'D'  done: the result is whole
///
/// A helper that ends without 'D' or 'E' has crashed or hit a limit, and the Error says which.
struct ChildOptions {
  std::string helper;                  ///< program name: "alidade-ifc-convert"
  std::vector<std::string> arguments;  ///< the input file's path last
  std::string inputName;               ///< named in errors; the input file's path
  std::string purpose = "Reading";     ///< "Reading hall.ifc", shown until the helper reports
  std::uint64_t memoryBytes = std::uint64_t{2} << 30;  ///< address space of the helper
  std::uint64_t resultBytes = std::uint64_t{1} << 30;  ///< longest result accepted
  double cpuSecs = 300;                ///< processor time, all threads
  double wallSecs = 600;
};

/// Runs the helper to its end and returns its result. Blocks; call it from a worker thread. Thread-safe.
/// Leaves no process and no file behind: the helper is killed on cancel, on a limit, and by the kernel
/// when the calling thread dies.
Result<std::vector<std::byte>> runChild(const ChildOptions& options, const Progress& progress);

/// The full path of a helper program: in ALIDADE_HELPER_PATH, beside the library or program that holds this
/// code, in `..` of it, or in `../lib/alidade`. Error where there is none.
Result<std::string> findHelper(const std::string& name);

/// Limits for a helper that reads a file of this size: a base for the program itself and a small multiple
/// of the size.
void scaleLimits(ChildOptions& options, std::uint64_t fileBytes, std::uint64_t memoryPerByte, double secsPerMiB);

/// The helper's end of the pipe. One per process; not thread-safe.
class ChildReporter {
 public:
  static constexpr int kDescriptor = 3;

  /// fraction in [0,1]; at most one message every 30 ms goes out.
  void progress(double fraction, std::string_view what);
  /// Both end the conversation; the return value is the exit status for main().
  int fail(const Error& error);
  int done(std::span<const std::byte> result);

 private:
  bool send(char kind, std::span<const std::byte> payload);
  std::int64_t m_lastProgressMs = -1000;
};

}  // namespace alidade
