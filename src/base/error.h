// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace alidade {

/// An expected failure, worded for the user: what happened, where, and what to do about it.
///
/// A bug asserts; an expected failure returns Result<T>; a library's exception is caught in its
/// owner folder and becomes an Error there. Context is added on the way up with `in()`.
struct Error {
  std::string what;    ///< A sentence without a full stop: "The LAS header promises 12 points, the file holds 7"
  std::string where;   ///< File, offset, element; may be empty.
  std::string advice;  ///< What to do next; may be empty.

  /// "what (where). advice", for a message panel or a terminal.
  std::string text() const;

  /// The same error with `place` put before the place already named.
  Error in(const std::string& place) const;
};

template <class T>
using Result = tl::expected<T, Error>;

/// `return fail("what happened", "where", "what to do");`
inline tl::unexpected<Error> fail(std::string what, std::string where = {}, std::string advice = {}) {
  return tl::unexpected<Error>(Error{std::move(what), std::move(where), std::move(advice)});
}

/// `if (!part) return fail(part.error());`
inline tl::unexpected<Error> fail(Error error) {
  return tl::unexpected<Error>(std::move(error));
}

/// Cancelling is no failure of the file: one wording for all jobs, and one way to ask for it.
Error cancelledError();
bool isCancelled(const Error& error);

}  // namespace alidade
