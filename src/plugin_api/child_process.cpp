// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "plugin_api/child_process.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

namespace alidade {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// A descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : m_fd(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { close(); }
  int get() const { return m_fd; }
  void reset(int fd) {
    close();
    m_fd = fd;
  }
  void close() {
    if (m_fd >= 0) ::close(m_fd);
    m_fd = -1;
  }

 private:
  int m_fd;
};

struct Pipe {
  Descriptor read, write;
  bool open() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) return false;
    read.reset(ends[0]);
    write.reset(ends[1]);
    return true;
  }
};

/// A running helper: killed and reaped when it goes out of scope, so that no zombie stays.
class Process {
 public:
  explicit Process(pid_t pid) : m_pid(pid) {}
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process() {
    if (m_pid > 0) {
      kill();
      wait();
    }
  }
  void kill() const { ::kill(m_pid, SIGKILL); }
  /// Exit status as waitpid gives it.
  int wait() {
    int status = 0;
    while (::waitpid(m_pid, &status, 0) < 0 && errno == EINTR) {
    }
    m_pid = -1;
    return status;
  }

 private:
  pid_t m_pid;
};

/// All that the child needs between fork and exec, prepared before: only async-signal-safe calls are
/// allowed there, because other threads of the parent may hold the allocator's locks.
struct Launch {
  const char* program;
  char* const* argv;
  char* const* envp;
  int reportFd, errorFd, nullFd;
  rlim_t memory, cpu;
  pid_t parent;
};

void limit(int what, rlim_t value) {
  const rlimit both{value, value};
  ::setrlimit(static_cast<__rlimit_resource_t>(what), &both);
}

[[noreturn]] void becomeHelper(const Launch& launch) {
  // The signal is tied to the thread that forked; that thread waits in runChild until the child ends.
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != launch.parent) ::_exit(127);
  // Move the pipes above the slots first, so that no dup2 overwrites one still needed.
  const int report = ::fcntl(launch.reportFd, F_DUPFD, 16);
  const int error = ::fcntl(launch.errorFd, F_DUPFD, 16);
  const int null = ::fcntl(launch.nullFd, F_DUPFD, 16);
  ::dup2(null, STDIN_FILENO);
  ::dup2(null, STDOUT_FILENO);
  ::dup2(error, STDERR_FILENO);
  ::dup2(report, ChildReporter::kDescriptor);
#ifdef SYS_close_range
  if (::syscall(SYS_close_range, ChildReporter::kDescriptor + 1, ~0U, 0) != 0)
#endif
    for (int fd = ChildReporter::kDescriptor + 1; fd < 1024; ++fd) ::close(fd);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  for (const int signal : {SIGPIPE, SIGINT, SIGTERM, SIGCHLD}) ::signal(signal, SIG_DFL);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);  // helpers write no files
  limit(RLIMIT_CPU, launch.cpu);
#ifndef __SANITIZE_ADDRESS__  // the sanitizer reserves terabytes of addresses
  limit(RLIMIT_AS, launch.memory);
#endif
  ::execve(launch.program, launch.argv, launch.envp);
  ::_exit(127);
}

std::vector<std::string> helperEnvironment() {
  // "C" numbers whatever the user's language, and nothing else of the user's settings.
  std::vector<std::string> result{"LC_ALL=C.UTF-8", "PATH=/usr/bin:/bin"};
  for (const char* name : {"LD_LIBRARY_PATH", "ASAN_OPTIONS", "UBSAN_OPTIONS", "LLVM_PROFILE_FILE"})
    if (const char* value = std::getenv(name)) result.push_back(std::string(name) + "=" + value);
  return result;
}

std::vector<char*> pointers(std::vector<std::string>& strings) {
  std::vector<char*> result;
  for (std::string& s : strings) result.push_back(s.data());
  result.push_back(nullptr);
  return result;
}

/// Cuts the stream from the helper into messages.
class MessageReader {
 public:
  explicit MessageReader(std::uint64_t resultLimit) : m_resultLimit(resultLimit) {}

  std::vector<std::byte> result;
  std::optional<Error> error;
  bool done = false, garbage = false, tooLong = false;
  double fraction = 0;
  std::string what;

  void take(const std::byte* data, std::size_t size) {
    m_pending.insert(m_pending.end(), data, data + size);
    std::size_t at = 0;
    while (!garbage && !tooLong && m_pending.size() - at >= 5) {
      std::uint32_t length = 0;
      for (int i = 0; i < 4; ++i) length |= std::to_integer<std::uint32_t>(m_pending[at + 1 + i]) << (8 * i);
      if (done || error || length > kLongestMessage) {
        garbage = true;
        return;
      }
      if (m_pending.size() - at - 5 < length) break;
      handle(std::to_integer<char>(m_pending[at]), std::span(m_pending).subspan(at + 5, length));
      at += 5 + length;
    }
    m_pending.erase(m_pending.begin(), m_pending.begin() + static_cast<std::ptrdiff_t>(at));
  }

  static constexpr std::uint32_t kLongestMessage = 1 << 20;

 private:
  void handle(char kind, std::span<const std::byte> payload) {
    const std::string_view text(reinterpret_cast<const char*>(payload.data()), payload.size());
    switch (kind) {
      case 'P': handleProgress(text); break;
      case 'E': handleError(text); break;
      case 'D': done = true; break;
      case 'R':
        tooLong = result.size() + payload.size() > m_resultLimit;
        if (!tooLong) result.insert(result.end(), payload.begin(), payload.end());
        break;
      default: garbage = true;
    }
  }

  void handleProgress(std::string_view text) {
    const auto blank = text.find(' ');
    double value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + std::min(blank, text.size()), value);
    if (code != std::errc() || !(value >= 0 && value <= 1) || blank == text.npos) {
      garbage = true;
      return;
    }
    fraction = value;
    what = text.substr(blank + 1);
  }

  void handleError(std::string_view text) {
    std::array<std::string, 3> part;
    for (std::string& p : part) {
      const auto end = text.find('\0');
      if (end == text.npos) {
        garbage = true;
        return;
      }
      p = text.substr(0, end);
      text.remove_prefix(end + 1);
    }
    error = Error{part[0], part[1], part[2]};
  }

  std::uint64_t m_resultLimit;
  std::vector<std::byte> m_pending;
};

enum class Ending { Closed, Cancelled, WallTime, Garbage, TooLong };

/// Reads both pipes until the helper closes them, a limit is hit or the user cancels.
Ending listen(const ChildOptions& options, Descriptor& report, Descriptor& errors, MessageReader& reader,
              std::string& errorTail, const Progress& progress) {
  const auto deadline = Clock::now() + std::chrono::duration<double>(options.wallSecs);
  std::vector<std::byte> buffer(1 << 16);
  std::string shown = options.purpose;
  progress.report(0, shown);
  while (report.get() >= 0) {
    if (progress.cancelled()) return Ending::Cancelled;
    if (Clock::now() > deadline) return Ending::WallTime;
    pollfd fds[2] = {{report.get(), POLLIN, 0}, {errors.get(), POLLIN, 0}};
    if (::poll(fds, 2, 30) < 0 && errno != EINTR) return Ending::Garbage;
    if (fds[1].fd >= 0 && fds[1].revents) {
      const ssize_t n = ::read(errors.get(), buffer.data(), buffer.size());
      if (n > 0) errorTail.append(reinterpret_cast<const char*>(buffer.data()), static_cast<std::size_t>(n));
      else if (n == 0 || errno != EINTR) errors.close();
      if (errorTail.size() > 4096) errorTail.erase(0, errorTail.size() - 4096);
    }
    if (fds[0].revents) {
      const ssize_t n = ::read(report.get(), buffer.data(), buffer.size());
      if (n > 0) reader.take(buffer.data(), static_cast<std::size_t>(n));
      else if (n == 0 || errno != EINTR) report.close();
      if (reader.garbage) return Ending::Garbage;
      if (reader.tooLong) return Ending::TooLong;
      if (!reader.what.empty()) shown = reader.what;
      progress.report(reader.fraction, shown);
    }
  }
  return Ending::Closed;
}

std::string mebibytes(std::uint64_t bytes) {
  return fmt::format("{} MiB", bytes >> 20);
}

Error endedBadly(const ChildOptions& options, int status, const std::string& errorTail) {
  const std::string& name = options.inputName;
  const bool memory = errorTail.find("bad_alloc") != std::string::npos ||
                      errorTail.find("out of memory") != std::string::npos ||
                      errorTail.find("cannot allocate memory") != std::string::npos;
  if (memory)
    return {fmt::format("The converter needed more than {} of memory for this file", mebibytes(options.memoryBytes)),
            name, "Split the model, or export it with fewer details"};
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    if (signal == SIGXCPU || signal == SIGKILL)
      return {fmt::format("The converter was stopped after {:.0f} s of processor time or for lack of memory",
                          options.cpuSecs),
              name, "Split the model, or export it with fewer details"};
    return {fmt::format("The converter crashed on this file (signal {}, {})", signal, ::strsignal(signal)), name,
            "The file is damaged or holds something that the converter does not know; export it again"};
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
    return {fmt::format("The helper program {} could not be started", options.helper), name,
            "Reinstall Alidade: a library that the helper needs is missing"};
  return {fmt::format("The converter ended without a result (exit status {})",
                      WIFEXITED(status) ? WEXITSTATUS(status) : -1),
          name, "The file is damaged or holds something that the converter does not know; export it again"};
}

Result<pid_t> start(const ChildOptions& options, const Pipe& report, const Pipe& errors) {
  auto program = findHelper(options.helper);
  if (!program) return fail(program.error());
  std::vector<std::string> arguments{*program};
  arguments.insert(arguments.end(), options.arguments.begin(), options.arguments.end());
  std::vector<std::string> environment = helperEnvironment();
  const std::vector<char*> argv = pointers(arguments), envp = pointers(environment);
  const Descriptor null(::open("/dev/null", O_RDWR | O_CLOEXEC));
  const Launch launch{program->c_str(),
                      argv.data(),
                      envp.data(),
                      report.write.get(),
                      errors.write.get(),
                      null.get(),
                      static_cast<rlim_t>(options.memoryBytes),
                      static_cast<rlim_t>(std::max(1.0, options.cpuSecs)),
                      ::getpid()};
  const pid_t pid = ::fork();
  if (pid == 0) becomeHelper(launch);
  if (pid < 0)
    return fail(fmt::format("The helper program {} could not be started: {}", options.helper, std::strerror(errno)),
                options.inputName, "Close other programs and try again");
  return pid;
}

std::vector<fs::path> helperFolders() {
  std::vector<fs::path> folders;
  if (const char* set = std::getenv("ALIDADE_HELPER_PATH")) folders.emplace_back(set);
  std::vector<fs::path> here;
  Dl_info info{};
  if (::dladdr(reinterpret_cast<const void*>(&findHelper), &info) && info.dli_fname)
    here.push_back(fs::path(info.dli_fname).parent_path());
  std::error_code code;
  const fs::path self = fs::read_symlink("/proc/self/exe", code);
  if (!code) here.push_back(self.parent_path());
  for (const fs::path& folder : here) {
    folders.push_back(folder);
    folders.push_back(folder / "..");
    folders.push_back(folder / ".." / "lib" / "alidade");
  }
  return folders;
}

}  // namespace

Result<std::string> findHelper(const std::string& name) {
  for (const fs::path& folder : helperFolders()) {
    std::error_code code;
    const fs::path path = fs::weakly_canonical(folder / name, code);
    if (!code && fs::is_regular_file(path, code) && ::access(path.c_str(), X_OK) == 0) return path.string();
  }
  return fail(fmt::format("The helper program {} is missing", name), {}, "Reinstall Alidade");
}

void scaleLimits(ChildOptions& options, std::uint64_t fileBytes, std::uint64_t memoryPerByte, double secsPerMiB) {
  constexpr std::uint64_t kBase = std::uint64_t{512} << 20;
  constexpr std::uint64_t kMost = std::uint64_t{32} << 30;
  const double mebi = static_cast<double>(fileBytes) / (1 << 20);
  options.memoryBytes = kBase + std::min(kMost, fileBytes > kMost / memoryPerByte ? kMost : fileBytes * memoryPerByte);
  options.resultBytes = options.memoryBytes / 2;
  options.cpuSecs = 15 + secsPerMiB * mebi;
  options.wallSecs = 4 * options.cpuSecs;
}

Result<std::vector<std::byte>> runChild(const ChildOptions& options, const Progress& progress) {
  if (progress.cancelled()) return fail(cancelledError());
  Pipe report, errors;
  if (!report.open() || !errors.open())
    return fail("No pipe to a helper program could be opened", options.inputName, "Close other programs and try again");
  auto pid = start(options, report, errors);
  if (!pid) return fail(pid.error());
  Process process(*pid);
  report.write.close();
  errors.write.close();

  MessageReader reader(options.resultBytes);
  std::string errorTail;
  const Ending ending = listen(options, report.read, errors.read, reader, errorTail, progress);
  // Once the answer is whole, nothing that the helper does while it cleans up matters.
  if (ending != Ending::Closed || reader.done || reader.error) process.kill();
  const int status = process.wait();
  switch (ending) {
    case Ending::Cancelled: return fail(cancelledError());
    case Ending::WallTime:
      return fail(fmt::format("The converter did not finish within {:.0f} s", options.wallSecs), options.inputName,
                  "Split the model, or export it with fewer details");
    case Ending::TooLong:
      return fail(fmt::format("The converted model is larger than {}", mebibytes(options.resultBytes)),
                  options.inputName, "Split the model, or export it with fewer details");
    case Ending::Garbage:
      return fail("The converter's answer makes no sense", options.inputName,
                  "The file is damaged or holds something that the converter does not know; export it again");
    case Ending::Closed: break;
  }
  if (reader.error) return fail(*reader.error);
  if (!reader.done) return fail(endedBadly(options, status, errorTail));
  return std::move(reader.result);
}

void ChildReporter::progress(double fraction, std::string_view what) {
  const std::int64_t now =
      std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now().time_since_epoch()).count();
  if (now - m_lastProgressMs < 30) return;
  m_lastProgressMs = now;
  const std::string text = fmt::format("{:.4f} {}", std::clamp(fraction, 0.0, 1.0), what);
  send('P', std::as_bytes(std::span(text)));
}

int ChildReporter::fail(const Error& error) {
  std::string text;
  for (const std::string* part : {&error.what, &error.where, &error.advice}) text.append(part->substr(0, 4096)) += '\0';
  return send('E', std::as_bytes(std::span(text))) ? 0 : 1;
}

int ChildReporter::done(std::span<const std::byte> result) {
  while (!result.empty()) {
    const auto piece = result.first(std::min<std::size_t>(result.size(), MessageReader::kLongestMessage));
    if (!send('R', piece)) return 1;
    result = result.subspan(piece.size());
  }
  return send('D', {}) ? 0 : 1;
}

bool ChildReporter::send(char kind, std::span<const std::byte> payload) {
  std::array<std::byte, 5> head{static_cast<std::byte>(kind)};
  for (int i = 0; i < 4; ++i) head[1 + i] = static_cast<std::byte>(payload.size() >> (8 * i));
  for (std::span<const std::byte> part : {std::span<const std::byte>(head), payload}) {
    while (!part.empty()) {
      const ssize_t n = ::write(kDescriptor, part.data(), part.size());
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return false;
      part = part.subspan(static_cast<std::size_t>(n));
    }
  }
  return true;
}

}  // namespace alidade
