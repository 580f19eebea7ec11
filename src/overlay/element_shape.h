// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "survey/design_model.h"

namespace alidade {

/// Whether an element's triangles close a solid, and which way round. The numbers are the shaders'.
enum class Winding : std::uint32_t { Open = 0, Outwards = 1, Inwards = 2 };

struct ElementShape {
  Winding winding = Winding::Open;
  double area = 0;  ///< of all triangles, square metres
};

/// Closed where every edge is passed as often one way as the other, by the position of its ends, so
/// that corners stored twice do not matter. A sum of the edges' signed hashes that vanishes stands for the
/// pairing: an open mesh passes for closed once in 2^64. A range beyond the model is open and empty.
ElementShape shapeOf(const DesignModel& model, const DesignElement& element);

/// Those of all elements, computed once a model and kept while the model lives. Thread-safe.
std::shared_ptr<const std::vector<ElementShape>> shapesOf(const std::shared_ptr<const DesignModel>& model);

/// Which of several elements behind a visible face is drawn through it: the one of less area, by steps of
/// half an octave, so that a pipe shows before the bed that it lies in. 0 to 63, 63 for the smallest.
std::uint32_t hiddenRank(double area);

}  // namespace alidade
