// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "base/error.h"

namespace alidade {

namespace {
constexpr const char* kCancelled = "Cancelled";
}

std::string Error::text() const {
  std::string line = what;
  if (!where.empty()) line += " (" + where + ")";
  if (!advice.empty()) line += ". " + advice;
  return line;
}

Error Error::in(const std::string& place) const {
  Error wider = *this;
  wider.where = where.empty() ? place : place + ", " + where;
  return wider;
}

Error cancelledError() {
  return Error{kCancelled, {}, {}};
}

bool isCancelled(const Error& error) {
  return error.what == kCancelled;
}

}  // namespace alidade
