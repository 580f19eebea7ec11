// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/part_index.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>

#include "cloud/distribution.h"
#include "cloud/part_stages.h"

namespace alidade {

namespace {

constexpr std::uint64_t kFewestSampled = 100'000, kMostSampled = 1'000'000;

/// What the sample says of a scan.
struct Survey {
  std::vector<glm::dvec3> positions;
  Bounds bounds;
  PointSchema schema;
  std::uint16_t brightest = 0;
};

Result<Survey> surveyOf(const ScanSource& source, const Progress& progress) {
  Survey survey;
  const std::uint64_t wanted = std::clamp(source.info.pointCount / 50, kFewestSampled, kMostSampled);
  const auto look = [&](PointBatch& batch) {
    survey.schema.include(batch);
    for (const std::uint16_t intensity : batch.intensity) survey.brightest = std::max(survey.brightest, intensity);
    for (const glm::dvec3& p : batch.position)
      if (isUsablePosition(p)) survey.positions.push_back(p), survey.bounds.add(p);
    return !progress.cancelled();
  };
  Result<void> read;
  if (source.sample) {
    read = source.sample(wanted, look, progress);
  } else {
    const std::uint64_t step = std::max<std::uint64_t>(1, source.info.pointCount / wanted);
    std::uint64_t skip = 0;
    read = source.read(
        [&](PointBatch& batch) {
          const std::size_t count = batch.size();
          PointBatch some = batch.every(std::min<std::uint64_t>(skip, count), step);
          skip = skip + some.size() * step - std::min<std::uint64_t>(count, skip + some.size() * step);
          return look(some);
        },
        progress);
  }
  if (progress.cancelled()) return fail(cancelledError());
  if (!read) return fail(read.error());
  const Bounds& stated = source.info.bounds;
  if (!stated.empty() && isUsablePosition(stated.min) && isUsablePosition(stated.max)) survey.bounds.add(stated);
  return survey;
}

LatticeEvidence evidenceOf(const ScanSource& source, const Survey& survey) {
  LatticeEvidence evidence;
  evidence.scale = source.info.scale;
  evidence.offset = source.info.offset;
  evidence.bounds = survey.bounds;
  evidence.pointCount = std::max<std::uint64_t>(source.info.pointCount, survey.positions.size());
  evidence.sample = survey.positions;
  evidence.wholeSample = survey.positions.size() >= source.info.pointCount;
  return evidence;
}

/// Zhang's law for this many points over this extent: its level 0 is the root cube's.
void fillLaw(const Survey& survey, const Lattice& lattice, std::uint64_t points, int dimensions, TreeOptions& tree) {
  tree.law = LevelLaw::forPointCount(points, dimensions);
  const glm::dvec3 size = survey.bounds.size();
  const double root = std::max({size.x, size.y, size.z, lattice.step});
  tree.lawShift = std::clamp(std::round(std::log2(root / (lattice.step * 65536.0))), -15.0, 15.0);
}

}  // namespace

std::uint64_t cellPointsFor(std::uint64_t pointCount) {
  return std::clamp<std::uint64_t>(pointCount / 16, 50'000, 500'000);
}

Result<PartTree> indexPart(const ScanSource& source, const PartOptions& options, PartSink& sink, const Progress& progress) {
  try {
    const auto past = sink.diary();
    if (!past.empty()) {
      auto resumed = PartStages::resume(past, options, sink);
      if (resumed) return (*resumed)->run(progress.part(0.4, 1.0));
    }
    auto survey = surveyOf(source, progress.part(0.0, 0.04));
    if (!survey) return fail(survey.error());
    for (int attempt = 0;;) {
      const Lattice lattice = chooseLattice(evidenceOf(source, *survey), attempt);
      std::vector<glm::i64vec3> units(survey->positions.size());
      if (!lattice.unitsOf(survey->positions, units.data(), nullptr)) {
        if (++attempt <= 2) continue;
        return fail("The scan's coordinates cannot be put on one grid", source.name, "Cut the scan into smaller parts");
      }
      const ChunkPlan plan(units, source.info.pointCount, options.cellPoints);
      units = {};

      const RecordLayout layout(lattice, survey->schema);
      RecordStreams::Options streamOptions;
      streamOptions.recordBytes = layout.bytes;
      streamOptions.spillPath = sink.spillPath();
      const std::uint64_t open = std::uint64_t{streamsFor(plan)} * static_cast<std::uint64_t>(options.threads);
      std::size_t extent = 1 << 17;
      while (extent > (1 << 13) && open * extent > options.memoryBytes / 8) extent /= 2;
      streamOptions.extentBytes = std::max<std::size_t>(extent, (layout.bytes + 16 + 4095) / 4096 * 4096);
      const std::uint64_t inMemory = options.memoryBytes / 5 * 2;
      const bool fits = source.info.pointCount <= inMemory / (layout.bytes + 1);
      streamOptions.memoryBytes = fits ? inMemory : 0;
      auto streams = std::make_unique<RecordStreams>(streamOptions);

      auto spread = distribute(source, plan, lattice, survey->schema, {options.threads, survey->brightest}, *streams,
                               progress.part(0.04, 0.4));
      if (!spread) return fail(spread.error());
      if (spread->outcome == DistributionResult::Outcome::NewColumns) {
        survey->schema = spread->schema;
        continue;
      }
      if (spread->outcome == DistributionResult::Outcome::OffLattice) {
        // The header's bounds may be wrong as well: the next lattice is chosen on what was seen.
        if (++attempt <= 2) continue;
        return fail("The scan's coordinates cannot be put on one grid", source.name, "Cut the scan into smaller parts");
      }
      std::uint64_t count = 0;
      for (const FilledCell& cell : spread->cells) count += cell.count;
      TreeOptions tree = options.tree;
      fillLaw(*survey, lattice, count, options.dimensions, tree);
      survey = fail("");  // its memory is wanted
      const PointSchema schema = spread->schema;
      PartStages stages(lattice, schema, tree, std::move(*spread), std::move(streams), options, sink);
      if (auto begun = stages.begin(); !begun) return fail(begun.error());
      return stages.run(progress.part(0.4, 1.0));
    }
  } catch (const std::bad_alloc&) {
    return fail("There is not enough memory to index the scan", source.name, "Close other programs or open a thinned version of the scan");
  }
}

}  // namespace alidade
