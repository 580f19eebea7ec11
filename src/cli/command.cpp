// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/command.h"

#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <iostream>

#include <fmt/format.h>
#include <unistd.h>

namespace alidade::cli {

namespace {

volatile std::sig_atomic_t g_interrupted = 0;

void onInterrupt(int) {
  g_interrupted = 1;
}

/// Draws on standard error, and only where that is a terminal: pipes and logs stay clean.
class Bar {
 public:
  Progress progress() {
    m_progress = Progress([this](double fraction, std::string_view what) { draw(fraction, what); });
    return m_progress;
  }
  void clear() const {
    if (m_drawn) std::fputs("\r\033[K", stderr);
  }

 private:
  void draw(double fraction, std::string_view what) {
    if (g_interrupted) m_progress.cancel();
    if (!m_terminal) return;
    constexpr int kWidth = 24;
    std::string bar(kWidth, ' ');
    for (int i = 0; i < static_cast<int>(fraction * kWidth); ++i) bar[i] = '=';
    std::fprintf(stderr, "\r\033[K[%s] %3d %%  %.*s", bar.c_str(), static_cast<int>(fraction * 100),
                 static_cast<int>(what.size()), what.data());
    m_drawn = true;
  }
  bool m_terminal = isatty(STDERR_FILENO) != 0;
  bool m_drawn = false;
  Progress m_progress;
};

/// Paths are bytes and JSON is UTF-8: what is not becomes the replacement character.
std::string textOf(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
}

std::string jsonOf(const Error& error) {
  return textOf({{"error", {{"what", error.what}, {"where", error.where}, {"advice", error.advice}}}});
}

}  // namespace

CLI::App* Verbs::add(const std::string& name, const std::string& description, Verb run) {
  CLI::App* command = m_app.add_subcommand(name, description);
  auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "Answer as one JSON object on standard output");
  m_entries.push_back({command, std::move(run), std::move(json)});
  return command;
}

namespace {

/// Sends what libraries print on standard output to standard error while a verb runs: the answer alone is
/// what scripts read.
class QuietOutput {
 public:
  QuietOutput() : m_output(::dup(STDOUT_FILENO)) {
    std::fflush(stdout);
    if (m_output >= 0) ::dup2(STDERR_FILENO, STDOUT_FILENO);
  }
  ~QuietOutput() {
    if (m_output < 0) return;
    std::fflush(stdout);
    std::cout.flush();
    ::dup2(m_output, STDOUT_FILENO);
    ::close(m_output);
  }
  QuietOutput(const QuietOutput&) = delete;
  QuietOutput& operator=(const QuietOutput&) = delete;

 private:
  int m_output;
};

}  // namespace

namespace {

/// What is said of a text that is no finite number, or of a number that `isRight` does not take.
CLI::Validator numberChecked(std::function<bool(double)> isRight, const std::string& wanted, const std::string& name) {
  return CLI::Validator(
      [=](std::string& text) {
        double value = 0;
        const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
        const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
        const bool number = error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
        return number && isRight(value) ? std::string() : fmt::format("'{}' is no {}", text, wanted);
      },
      name);
}

}  // namespace

CLI::Validator finiteNumber() {
  return numberChecked([](double) { return true; }, "finite number", "NUMBER");
}

CLI::Validator positiveNumber() {
  return numberChecked([](double value) { return value > 0; }, "finite number above 0", "POSITIVE");
}

CLI::Validator numberWithin(double low, double high) {
  return numberChecked([=](double value) { return value >= low && value <= high; }, fmt::format("number from {} to {}", low, high),
                       fmt::format("{} to {}", low, high));
}

int Verbs::run() const {
  for (const Entry& entry : m_entries) {
    if (!entry.command->parsed()) continue;
    std::signal(SIGINT, onInterrupt);
    // A file size limit then is an error like a full disk, with a message and nothing left behind.
    std::signal(SIGXFSZ, SIG_IGN);
    Bar bar;
    const auto answer = [&] {
      const QuietOutput quiet;
      return entry.run(bar.progress());
    }();
    bar.clear();
    if (!answer) {
      if (*entry.json) std::cout << jsonOf(answer.error()) << std::flush;
      std::cerr << "alidade-cli: " << answer.error().text() << '\n';
      return 1;
    }
    if (*entry.json) std::cout << textOf(answer->json);
    else std::cout << answer->text;
    std::cout.flush();
    if (!std::cout) {
      std::cerr << "alidade-cli: The answer could not be written to standard output\n";
      return 1;
    }
    return answer->failed ? 1 : 0;
  }
  return 2;
}

int Verbs::refuse(const CLI::ParseError& error, bool json) const {
  constexpr int kBadUsage = 2;
  std::string what = error.what();
  std::string verb;
  for (const Entry& entry : m_entries)
    if (entry.command->parsed()) verb = entry.command->get_name() + " ";
  if (const auto words = m_app.remaining(); verb.empty() && !words.empty()) what = "There is no verb '" + words.front() + "'";
  const Error usage{what, {}, "See alidade-cli " + verb + "--help"};
  if (json) std::cout << jsonOf(usage) << std::flush;
  std::cerr << "alidade-cli: " << usage.text() << '\n';
  return kBadUsage;
}

}  // namespace alidade::cli
