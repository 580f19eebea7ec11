// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

namespace alidade {

/// How a splat kernel gets 1/z.
enum class Reciprocal {
  Division,     ///< correctly rounded: every kernel gives the same picture
  Newton,       ///< the processor's estimate and one Newton step: some 3e-7, by processor
  MultiplyAdd,  ///< 2/R - z/R² about a node's depth R where its error is small enough, else Division
};

}  // namespace alidade
