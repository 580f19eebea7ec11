// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Stands in for libFuzzer where the compiler has none. It follows no coverage: it takes a file of the
// corpus and damages it in the ways that break readers. The same seed gives the same inputs; on a
// crash, a sanitizer's finding included, the input is in alidade_fuzz_input in the working folder.

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

// The sanitizers ask for these. By default they end the process without a signal, and the input is lost.
extern "C" const char* __asan_default_options() { return "abort_on_error=1"; }
extern "C" const char* __ubsan_default_options() { return "abort_on_error=1:print_stacktrace=1"; }

namespace {

using Bytes = std::vector<std::uint8_t>;
using Random = std::mt19937_64;

Bytes g_current;  // what is being tried, for the crash handler

constexpr unsigned kSlowestInputSecs = 20;

extern "C" void onCrash(int signal) {
  const int file = ::open("alidade_fuzz_input", O_CREAT | O_WRONLY | O_TRUNC, 0644);
  if (file >= 0) {
    const ssize_t written = ::write(file, g_current.data(), g_current.size());
    static_cast<void>(written);
    ::close(file);
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void tryInput(const Bytes& input) {
  g_current = input;
  ::alarm(kSlowestInputSecs);  // a hang is a failure too
  LLVMFuzzerTestOneInput(g_current.data(), g_current.size());
  ::alarm(0);
}

std::vector<Bytes> loadCorpus(const std::vector<std::string>& folders) {
  constexpr std::uintmax_t kLargest = 200000;
  std::vector<std::filesystem::path> paths;
  for (const auto& folder : folders) {
    if (!std::filesystem::exists(folder)) continue;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
      if (entry.is_regular_file() && entry.file_size() <= kLargest) paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  std::vector<Bytes> corpus;
  for (const auto& path : paths) {
    std::ifstream file(path, std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  if (corpus.empty()) corpus.push_back({});
  return corpus;
}

/// Headers are where the lies are told: half of all damage goes to the first 512 bytes.
std::size_t somewhere(const Bytes& input, Random& random) {
  if (input.empty()) return 0;
  const std::size_t reach = random() % 2 ? std::min<std::size_t>(input.size(), 512) : input.size();
  return random() % reach;
}

template <class T>
void putNumber(Bytes& input, std::size_t at, T value) {
  if (at + sizeof(T) <= input.size()) std::memcpy(&input[at], &value, sizeof(T));
}

void damageNumber(Bytes& input, std::size_t at, Random& random) {
  constexpr double kDoubles[] = {0.0, -1.0, 1e300, std::numeric_limits<double>::quiet_NaN(),
                                 std::numeric_limits<double>::infinity()};
  constexpr std::uint64_t kIntegers[] = {0, 1, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0xFFFFFFFF, ~0ull, 1ull << 63};
  const std::uint64_t value = kIntegers[random() % std::size(kIntegers)];
  switch (random() % 4) {
    case 0: putNumber(input, at, kDoubles[random() % std::size(kDoubles)]); break;
    case 1: putNumber(input, at, static_cast<std::uint16_t>(value)); break;
    case 2: putNumber(input, at, static_cast<std::uint32_t>(value)); break;
    default: putNumber(input, at, value); break;
  }
}

void damageText(Bytes& input, std::size_t at, Random& random) {
  static const char* const kWords[] = {"18446744073709551615", "-1", "nan", "1e300", "inf", "\n", " ", "0", "list", "\r"};
  const char* word = kWords[random() % std::size(kWords)];
  input.insert(input.begin() + static_cast<std::ptrdiff_t>(at), word, word + std::strlen(word));
}

Bytes mutate(const std::vector<Bytes>& corpus, Random& random) {
  Bytes input = corpus[random() % corpus.size()];
  for (std::uint64_t rounds = 1 + random() % 6; rounds > 0 && !input.empty(); --rounds) {
    const std::size_t at = somewhere(input, random);
    const auto place = input.begin() + static_cast<std::ptrdiff_t>(at);
    switch (random() % 8) {
      case 0: input[at] = static_cast<std::uint8_t>(random()); break;
      case 1: input[at] ^= static_cast<std::uint8_t>(1u << random() % 8); break;
      case 2: input.resize(at); break;
      case 3: input.erase(place, place + static_cast<std::ptrdiff_t>(std::min<std::size_t>(1 + random() % 16, input.size() - at))); break;
      case 4: input.insert(place, 1 + random() % 16, static_cast<std::uint8_t>(random())); break;
      case 5: damageText(input, at, random); break;
      case 6: {
        const Bytes& other = corpus[random() % corpus.size()];
        if (!other.empty()) input.insert(input.end(), other.begin() + static_cast<std::ptrdiff_t>(random() % other.size()), other.end());
        input.resize(std::min<std::size_t>(input.size(), 400000));
        break;
      }
      default: damageNumber(input, at, random); break;
    }
  }
  return input;
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t runs = std::numeric_limits<std::uint64_t>::max(), seed = 1;
  double seconds = 0;
  std::vector<std::string> folders;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--runs" && i + 1 < argc) runs = std::strtoull(argv[++i], nullptr, 10);
    else if (argument == "--seconds" && i + 1 < argc) seconds = std::strtod(argv[++i], nullptr);
    else if (argument == "--seed" && i + 1 < argc) seed = std::strtoull(argv[++i], nullptr, 10);
    else folders.push_back(argument);
  }
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGALRM}) std::signal(signal, onCrash);

  const std::vector<Bytes> corpus = loadCorpus(folders);
  for (const Bytes& input : corpus) tryInput(input);
  if (seconds <= 0 && runs == std::numeric_limits<std::uint64_t>::max()) runs = 1000;
  Random random(seed);
  const auto start = std::chrono::steady_clock::now();
  std::uint64_t done = 0;
  for (; done < runs; ++done) {
    if (seconds > 0 && std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > seconds) break;
    tryInput(mutate(corpus, random));
  }
  std::cout << corpus.size() << " files of the corpus and " << done << " mutations of them: no fault\n";
  return 0;
}
