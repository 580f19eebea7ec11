// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "base/log.h"

#include <cstdlib>
#include <map>
#include <mutex>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace alidade {

namespace {

struct Sinks {
  std::mutex mutex;
  std::map<int, std::function<void(LogLevel, const std::string&)>> byHandle;
  int next = 1;
};

Sinks& sinks() {
  static Sinks instance;
  return instance;
}

spdlog::logger& console() {
  static const auto logger = [] {
    auto made = spdlog::stderr_color_mt("alidade");
    made->set_pattern("%^%l%$: %v");
    const char* wanted = std::getenv("ALIDADE_LOG");
    made->set_level(wanted ? spdlog::level::from_str(wanted) : spdlog::level::warn);
    return made;
  }();
  return *logger;
}

spdlog::level::level_enum toSpdlog(LogLevel level) {
  switch (level) {
    case LogLevel::Debug: return spdlog::level::debug;
    case LogLevel::Info: return spdlog::level::info;
    case LogLevel::Warning: return spdlog::level::warn;
    case LogLevel::Error: return spdlog::level::err;
  }
  return spdlog::level::info;
}

}  // namespace

void log(LogLevel level, std::string_view message) {
  console().log(toSpdlog(level), message);
  const std::string text(message);
  std::lock_guard lock(sinks().mutex);
  for (const auto& [handle, sink] : sinks().byHandle) sink(level, text);
}

int addLogSink(std::function<void(LogLevel, const std::string&)> sink) {
  std::lock_guard lock(sinks().mutex);
  const int handle = sinks().next++;
  sinks().byHandle.emplace(handle, std::move(sink));
  return handle;
}

void removeLogSink(int handle) {
  std::lock_guard lock(sinks().mutex);
  sinks().byHandle.erase(handle);
}

}  // namespace alidade
