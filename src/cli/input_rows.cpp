// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/input_rows.h"

#include <cerrno>
#include <charconv>
#include <cstring>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

namespace alidade::cli {

namespace {

/// All of standard input. Waits in short steps, so that Ctrl+C ends a wait for somebody's typing.
Result<std::string> readInput(const char* what, const char* names, const Progress& progress) {
  constexpr int kWaitMs = 100;
  std::string text;
  std::vector<char> block(1 << 16);
  for (;;) {
    progress.report(0.0, fmt::format("Reading {} from standard input", what));
    if (progress.cancelled()) return fail(cancelledError());
    pollfd waiting{STDIN_FILENO, POLLIN, 0};
    const int ready = ::poll(&waiting, 1, kWaitMs);
    if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
    const ssize_t count = ::read(STDIN_FILENO, block.data(), block.size());
    if (count == 0) return text;
    if (count > 0) text.append(block.data(), static_cast<std::size_t>(count));
    else if (errno != EINTR && errno != EAGAIN)
      return fail(fmt::format("The {} cannot be read: {}", what, std::strerror(errno)), "standard input",
                  fmt::format("Give them by < FILE or through a pipe: {}, one a line", names));
  }
}

}  // namespace

Result<std::vector<std::vector<double>>> rowsFromInput(std::size_t columns, const char* what, const char* names, const Progress& progress) {
  const auto text = readInput(what, names, progress);
  if (!text) return fail(text.error());
  std::istringstream input(*text);
  std::vector<std::vector<double>> rows;
  std::string line;
  for (int number = 1; std::getline(input, line); ++number) {
    if (const auto remark = line.find('#'); remark != std::string::npos) line.erase(remark);
    const char* at = line.data();
    const char* const end = line.data() + line.size();
    const auto skip = [&] {
      while (at < end && (*at == ' ' || *at == '\t' || *at == ',' || *at == ';' || *at == '\r')) ++at;
    };
    skip();
    if (at == end) continue;
    std::vector<double> row(columns);
    for (double& value : row) {
      if (end - at > 1 && *at == '+' && at[1] != '-') ++at;  // from_chars takes no plus sign
      const auto [next, error] = std::from_chars(at, end, value);
      if (error != std::errc())
        return fail(fmt::format("A line needs {} numbers: {}", columns, names), fmt::format("standard input, line {}", number),
                    "Write figures with a decimal point, blanks or commas between, and # before remarks");
      at = next;
      skip();
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace alidade::cli
