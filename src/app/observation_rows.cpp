// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/observation_rows.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace alidade {

namespace {

constexpr const char* kAdvice =
    "The file needs the header u,v,e,n,h[,sigma_px][,name][,frame][,kind][,use][,sigma_m][,e2,n2,h2][,depth_m]";

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r\"");
  const auto last = text.find_last_not_of(" \t\r\"");
  return first == std::string::npos ? std::string() : text.substr(first, last - first + 1);
}

std::vector<std::string> cellsOf(const std::string& line) {
  std::vector<std::string> found;
  std::size_t start = 0;
  for (;;) {
    const auto comma = line.find(',', start);
    found.push_back(trimmed(line.substr(start, comma == std::string::npos ? comma : comma - start)));
    if (comma == std::string::npos) return found;
    start = comma + 1;
  }
}

std::string lowered(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::optional<double> number(const std::string& cell) {
  double value = 0;
  const char* begin = cell.data() + (cell.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// One line's cells by column name.
class Cells {
 public:
  Cells(const std::map<std::string, std::size_t>& column, std::vector<std::string> cells, std::string where)
      : m_column(column), m_cells(std::move(cells)), m_where(std::move(where)) {}

  const std::string& where() const { return m_where; }
  std::string text(const char* name) const {
    const auto at = m_column.find(name);
    return at == m_column.end() || at->second >= m_cells.size() ? std::string() : m_cells[at->second];
  }
  /// Nothing where all are empty; an error where some are, or are no numbers.
  template <std::size_t n>
  Result<std::optional<std::array<double, n>>> numbers(const std::array<const char*, n>& names) const {
    std::array<double, n> values{};
    std::size_t given = 0;
    std::string all;
    for (const char* name : names) {
      all += (all.empty() ? "" : ", ") + std::string(name);
      given += !text(name).empty();
    }
    if (given == 0) return std::nullopt;
    for (std::size_t i = 0; i < n; ++i) {
      const auto value = number(text(names[i]));
      if (!value) return fail(fmt::format("{} must be finite numbers", all), m_where, kAdvice);
      values[i] = *value;
    }
    return values;
  }

 private:
  const std::map<std::string, std::size_t>& m_column;
  std::vector<std::string> m_cells;
  std::string m_where;
};

Result<void> readNumbers(const Cells& cells, ObservationRow& row) {
  const auto pixel = cells.numbers<2>({"u", "v"});
  if (!pixel) return fail(pixel.error());
  const auto world = cells.numbers<3>({"e", "n", "h"});
  if (!world) return fail(world.error());
  const auto second = cells.numbers<3>({"e2", "n2", "h2"});
  if (!second) return fail(second.error());
  if (*world) row.world = glm::dvec3((**world)[0], (**world)[1], (**world)[2]);
  if (*second) row.second = glm::dvec3((**second)[0], (**second)[1], (**second)[2]);
  if (*pixel) row.pixel = {(**pixel)[0], (**pixel)[1]};
  const bool seen = row.kind != ObservationKind::Depth && row.kind != ObservationKind::Surface && row.kind != ObservationKind::Position;
  if (seen && !*pixel) return fail("u and v must be finite numbers", cells.where(), kAdvice);
  if (row.kind != ObservationKind::Tie && row.kind != ObservationKind::Depth && !row.world)
    return fail("e, n and h must be finite numbers", cells.where(), kAdvice);
  if ((row.kind == ObservationKind::Edge || row.kind == ObservationKind::Surface) && !row.second)
    return fail("e2, n2 and h2 must be finite numbers", cells.where(), "An edge needs its other end, a surface its normal there");
  for (const auto& [name, into] : {std::pair{"sigma_px", &row.sigmaPx}, {"sigma_m", &row.sigmaM}, {"depth_m", &row.depthM}}) {
    if (cells.text(name).empty()) continue;
    const auto value = number(cells.text(name));
    const bool zeroIsFine = into == &row.sigmaM && row.kind == ObservationKind::Control;
    if (!value || *value < 0 || (*value == 0 && !zeroIsFine))
      return fail(fmt::format("{} must be above 0", name), cells.where(), kAdvice);
    *into = *value;
  }
  if (row.kind == ObservationKind::Depth && !(row.depthM > 0)) return fail("depth_m must be above 0", cells.where(), kAdvice);
  return {};
}

Result<std::optional<ObservationRow>> readRow(const Cells& cells, int line) {
  static const std::map<std::string, ObservationKind> kinds{
      {"", ObservationKind::Control},       {"control", ObservationKind::Control}, {"scan", ObservationKind::Scan},
      {"tie", ObservationKind::Tie},        {"edge", ObservationKind::Edge},       {"depth", ObservationKind::Depth},
      {"surface", ObservationKind::Surface}, {"position", ObservationKind::Position}};
  ObservationRow row;
  row.where = cells.where();
  const std::string use = lowered(cells.text("use"));
  if (use == "0") return std::nullopt;
  if (!use.empty() && use != "1" && use != "check")
    return fail(fmt::format("use is '{}'", use), cells.where(), "Write 1, 0 or check");
  row.heldOut = use == "check";
  const auto kind = kinds.find(lowered(cells.text("kind")));
  if (kind == kinds.end())
    return fail(fmt::format("'{}' is no kind of observation", cells.text("kind")), cells.where(),
                "Write control, scan, tie, edge, depth, surface or position");
  row.kind = kind->second;
  // A surface holds its point, a position its pose: neither leaves a residual that could be looked at beside the fit.
  if (row.heldOut && (row.kind == ObservationKind::Surface || row.kind == ObservationKind::Position))
    return fail(fmt::format("A {} cannot be held out as a check", kind->first), cells.where(),
                "Write use 1 to adjust with it or 0 to leave it out; points, edges and depths can be checks");
  row.frame = cells.text("frame");
  row.name = cells.text("name");
  constexpr double scanSigmaM = 0.003, surfaceSigmaM = 0.005, depthSigmaM = 0.01;
  row.sigmaM = row.kind == ObservationKind::Control   ? 0
               : row.kind == ObservationKind::Surface ? surfaceSigmaM
               : row.kind == ObservationKind::Depth   ? depthSigmaM
                                                      : scanSigmaM;
  if (const auto done = readNumbers(cells, row); !done) return fail(done.error());
  const bool needsName = row.kind == ObservationKind::Tie || row.kind == ObservationKind::Depth || row.kind == ObservationKind::Surface;
  if (row.name.empty() && needsName)
    return fail("The point has no name", cells.where(), "Tie points, depths and surfaces are joined by name: add the column name");
  if (row.name.empty()) row.name = fmt::format("line {}", line);
  return row;
}

/// Where the header has each column; refuses what it does not know, so that no misspelt one is passed over.
Result<std::map<std::string, std::size_t>> columnsOf(const std::vector<std::string>& header, const std::string& path) {
  static constexpr std::array known{"u",    "v",   "e",       "n",  "h",  "sigma_px", "name",   "frame",
                                    "kind", "use", "sigma_m", "e2", "n2", "h2",       "depth_m"};
  if (header.size() == 1)
    for (const auto& [separator, name] : {std::pair{';', "semicolons"}, {'\t', "tabs"}})
      if (header[0].find(separator) != std::string::npos)
        return fail(fmt::format("The columns are separated by {}", name), path, "Separate them by commas, and write numbers with a decimal point");
  std::map<std::string, std::size_t> column;
  for (std::size_t i = 0; i < header.size(); ++i) {
    const std::string name = lowered(header[i]);
    if (name.empty()) return fail(fmt::format("Column {} has no name", i + 1), path, kAdvice);
    if (std::find(known.begin(), known.end(), name) == known.end())
      return fail(fmt::format("There is no column '{}'", header[i]), path,
                  fmt::format("The columns are {}{}", fmt::join(known, ", "),
                              name == "sigma" ? "; a pick's standard deviation is sigma_px, a point's sigma_m" : ""));
    if (!column.emplace(name, i).second) return fail(fmt::format("The column '{}' comes twice", name), path, "Delete one of the two");
  }
  for (const char* needed : {"u", "v", "e", "n", "h"})
    if (!column.contains(needed)) return fail(fmt::format("The column '{}' is missing", needed), path, kAdvice);
  return column;
}

}  // namespace

Result<std::vector<ObservationRow>> readObservationRows(const std::string& path) {
  std::ifstream file(path);
  if (!file) return fail("The observations cannot be opened", path, "Check that the file exists and may be read");
  std::string line;
  std::map<std::string, std::size_t> column;
  std::size_t columnCount = 0;
  std::vector<ObservationRow> rows;
  for (int lineNumber = 1; std::getline(file, line); ++lineNumber) {
    if (line.size() > 65536) return fail("A line is longer than 65536 characters", path, kAdvice);
    if (lineNumber == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    if (trimmed(line).empty() || line.front() == '#') continue;
    auto cells = cellsOf(line);
    if (column.empty()) {
      auto columns = columnsOf(cells, path);
      if (!columns) return fail(columns.error());
      column = std::move(*columns), columnCount = cells.size();
      continue;
    }
    const std::string where = fmt::format("{}, line {}", path, lineNumber);
    if (cells.size() != columnCount)
      return fail(fmt::format("The row has {} cells, the header {}", cells.size(), columnCount), where,
                  "Give every row a cell for each column, empty where nothing is to be said; write numbers with a decimal point, names without commas");
    auto row = readRow(Cells(column, std::move(cells), where), lineNumber);
    if (!row) return fail(row.error());
    if (*row) rows.push_back(std::move(**row));
  }
  if (rows.empty()) return fail("The file holds no observation", path, kAdvice);
  return rows;
}

}  // namespace alidade
