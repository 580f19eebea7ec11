// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/point_style_options.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/number_list.h"
#include "geometry/angle.h"
#include "survey/classification.h"

namespace alidade::cli {

namespace {

const std::map<std::string, ColourBy> kColours = {
    {"rgb", ColourBy::Rgb},           {"intensity", ColourBy::Intensity},
    {"height", ColourBy::Height},     {"class", ColourBy::Classification},
    {"return", ColourBy::Return},     {"time", ColourBy::GpsTime},
    {"scan", ColourBy::Scan},         {"distance", ColourBy::Distance},
    {"normal", ColourBy::Normal}};
const std::map<std::string, ColourRamp> kRamps = {
    {"viridis", ColourRamp::Viridis}, {"cividis", ColourRamp::Cividis}, {"grey", ColourRamp::Grey}};
const std::map<std::string, PointSizeLaw> kSizes = {
    {"spacing", PointSizeLaw::Spacing}, {"screen", PointSizeLaw::Screen}, {"fixed", PointSizeLaw::Fixed}};

Result<std::bitset<256>> parseClasses(const std::string& text) {
  const auto classes = classesOfText(text);
  if (!classes) return fail("'" + text + "' is no list of classes", "--hide-classes", "Give codes from 0 to 255, such as 7,18");
  return *classes;
}

Result<ClipBox> parseBox(const std::string& text) {
  const auto v = numberList(text, 6, 7, "--clip-box",
                         "Give E,N,H of the middle, then width, length, height in metres, then a heading in degrees if turned");
  if (!v) return fail(v.error());
  ClipBox box{true, {(*v)[0], (*v)[1], (*v)[2]}, {(*v)[3], (*v)[4], (*v)[5]}, 0};
  if (v->size() == 7) box.headingRad = radiansFromDegrees((*v)[6]);
  if (box.size.x <= 0 || box.size.y <= 0 || box.size.z <= 0)
    return fail("The box has no inside", "--clip-box", "Give a width, a length and a height above 0");
  return box;
}

Result<Section> parseSection(const std::string& text) {
  const auto v = numberList(text, 5, 6, "--section",
                         "Give E,N,H of a point on it, the azimuth that it faces in degrees, its thickness in metres "
                         "(0: all behind it), then the elevation of its normal in degrees if tilted");
  if (!v) return fail(v.error());
  Section section{true, {(*v)[0], (*v)[1], (*v)[2]}, radiansFromDegrees((*v)[3]), 0, (*v)[4]};
  if (v->size() == 6) section.elevationRad = radiansFromDegrees((*v)[5]);
  if (section.thicknessM < 0) return fail("The thickness is negative", "--section", "Give 0 or more metres");
  return section;
}

Result<CutPlane> parseCut(const std::string& text) {
  const auto v = numberList(text, 4, 5, "--clip-plane",
                            "Give E,N,H of a point on it and the azimuth that it faces in degrees, then the elevation of its normal in "
                            "degrees if tilted; what lies in front of it is cut off");
  if (!v) return fail(v.error());
  return CutPlane{true, {(*v)[0], (*v)[1], (*v)[2]}, radiansFromDegrees((*v)[3]), v->size() == 5 ? radiansFromDegrees((*v)[4]) : 0};
}

Result<std::pair<double, double>> parseRange(const std::string& text) {
  const auto v = numberList(text, 2, 2, "--range", "Give LOW,HIGH in the value's own unit");
  if (!v) return fail(v.error());
  if (!((*v)[0] < (*v)[1])) return fail("The range is empty", "--range", "Give LOW below HIGH");
  return std::pair{(*v)[0], (*v)[1]};
}

std::vector<std::string> namesOf(const auto& map) {
  std::vector<std::string> names;
  for (const auto& [name, value] : map) names.push_back(name);
  return names;
}

}  // namespace

struct PointStyleOptions::Given {
  std::string colourBy, ramp, range, classes, box, section, size;
  std::vector<std::string> cuts;
  bool eyeDome = false;
  std::optional<double> eyeDomeStrength;
};

PointStyleOptions::PointStyleOptions(CLI::App& command) : m_given(std::make_shared<Given>()) {
  command.add_option("--colour-by", m_given->colourBy, "What colours the points")->check(CLI::IsMember(namesOf(kColours)));
  command.add_option("--ramp", m_given->ramp, "How a number becomes a colour")->check(CLI::IsMember(namesOf(kRamps)));
  command.add_option("--range", m_given->range, "LOW,HIGH of the ramp; automatic where not given")
      ->check(checkedBy(parseRange, "LOW,HIGH"));
  command.add_option("--hide-classes", m_given->classes, "Classes whose points neither show nor hide, such as 7,18")
      ->check(checkedBy(parseClasses, "LIST"));
  command.add_option("--clip-box", m_given->box, "Use only points inside: E,N,H,WIDTH,LENGTH,HEIGHT[,HEADING]")
      ->check(checkedBy(parseBox, "BOX"));
  command.add_option("--section", m_given->section, "Use only a slab: E,N,H,AZIMUTH,THICKNESS[,ELEVATION]")
      ->check(checkedBy(parseSection, "SLAB"));
  command.add_option("--clip-plane", m_given->cuts, "Cut off what lies in front of a plane, again for more: E,N,H,AZIMUTH[,ELEVATION]")
      ->check(checkedBy(parseCut, "PLANE"))->allow_extra_args(false);
  command.add_option("--size-law", m_given->size, "How large points are drawn")->check(CLI::IsMember(namesOf(kSizes)));
  command.add_flag("--eye-dome", m_given->eyeDome, "Eye-Dome lighting on the points");
  command.add_option("--eye-dome-strength", m_given->eyeDomeStrength, "Of the Eye-Dome lighting; switches it on")->check(numberWithin(0.1, 5.0));
}

Result<void> PointStyleOptions::apply(PointStyle& style) const {
  const Given& given = *m_given;
  if (!given.colourBy.empty()) style.colourBy = kColours.at(given.colourBy);
  if (!given.ramp.empty()) style.ramp = kRamps.at(given.ramp);
  if (!given.size.empty()) style.sizeLaw = kSizes.at(given.size);
  if (given.eyeDome || given.eyeDomeStrength) style.eyeDome = true;
  if (given.eyeDomeStrength) style.eyeDomeStrength = *given.eyeDomeStrength;
  if (!given.range.empty()) {
    const auto range = parseRange(given.range);
    if (!range) return fail(range.error());
    style.automaticRange = false;
    std::tie(style.rangeLow, style.rangeHigh) = *range;
  }
  if (!given.classes.empty()) {
    const auto classes = parseClasses(given.classes);
    if (!classes) return fail(classes.error());
    style.hiddenClasses = *classes;
  }
  if (!given.box.empty()) {
    const auto box = parseBox(given.box);
    if (!box) return fail(box.error());
    style.clipBox = *box;
  }
  if (!given.section.empty()) {
    const auto section = parseSection(given.section);
    if (!section) return fail(section.error());
    style.section = *section;
  }
  if (!given.cuts.empty()) style.cuts.clear();  // those of the project, as with the box and the section
  for (const std::string& text : given.cuts) {
    const auto cut = parseCut(text);
    if (!cut) return fail(cut.error());
    style.cuts.push_back(*cut);
  }
  return {};
}

}  // namespace alidade::cli
