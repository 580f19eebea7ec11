// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace alidade {

enum class LogLevel { Debug, Info, Warning, Error };

/// One line to the log. Goes to standard error from Warning on (from Info with ALIDADE_LOG=info,
/// from Debug with ALIDADE_LOG=debug) and to every sink. Thread-safe.
void log(LogLevel level, std::string_view message);

inline void logInfo(std::string_view message) { log(LogLevel::Info, message); }
inline void logWarning(std::string_view message) { log(LogLevel::Warning, message); }
inline void logError(std::string_view message) { log(LogLevel::Error, message); }

/// The window's message panel listens here. Called on the logging thread. Returns a handle.
int addLogSink(std::function<void(LogLevel, const std::string&)> sink);
void removeLogSink(int handle);

}  // namespace alidade
