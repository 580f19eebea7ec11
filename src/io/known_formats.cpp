// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/known_formats.h"

#include <algorithm>

#include <fmt/format.h>

namespace alidade {

namespace {

struct KnownFormat {
  std::string_view name;
  std::string_view advice;
  std::string_view magic;       ///< the first bytes; empty where the ending alone tells
  std::string_view extensions;  ///< between blanks, lower case
};

constexpr std::string_view kAsIfc = "Export it from the design program as IFC4, IFC2x3, OBJ or glTF";
constexpr std::string_view kAsPicture = "Develop it to TIFF, PNG or JPEG without lens correction";

// By content first: an ending says what somebody called the file, not what it is.
constexpr KnownFormat kFormats[] = {
    {"AutoCAD drawing (DWG)", kAsIfc, "AC10", "dwg"},
    {"scanner maker's scan", "Export it from the maker's program as LAS or PLY", "", "fls rcp rcs zfs rxp rdbx lgs imp"},
    {"pose graph (g2o)", "Export the poses as a COLMAP text model or a TUM trajectory", "", "g2o"},
    {"IFC model in XML or ZIP", "Export it as plain IFC (STEP): IFC4 or IFC2x3", "", "ifcxml ifczip"},
    {"design program's own file", kAsIfc, "", "dxf dgn rvt rfa pln skp 3dm nwd nwc fbx dae step stp landxml"},
    {"camera maker's raw picture", kAsPicture, "", "dng cr2 cr3 nef arw orf rw2 raf"},
    {"HEIF picture", "Save it as JPEG or PNG in its full size", "", "heic heif avif"},
};

bool namesExtension(std::string_view list, std::string_view extension) {
  while (!extension.empty() && !list.empty()) {
    const auto blank = std::min(list.find(' '), list.size());
    if (list.substr(0, blank) == extension) return true;
    list.remove_prefix(std::min(blank + 1, list.size()));
  }
  return false;
}

Error refusal(const FileProbe& probe, std::string_view name, std::string_view advice) {
  return {fmt::format("The format is known but not read: {}", name), probe.path, std::string(advice)};
}

}  // namespace

std::optional<Error> refusalOfKnownFormat(const FileProbe& probe) {
  if (probe.isFolder) return std::nullopt;
  for (const KnownFormat& format : kFormats)
    if (!format.magic.empty() && probe.startsWith(format.magic)) return refusal(probe, format.name, format.advice);
  if (probe.holds("<LandXML")) return refusal(probe, "LandXML", kAsIfc);
  for (const KnownFormat& format : kFormats)
    if (namesExtension(format.extensions, probe.extension)) return refusal(probe, format.name, format.advice);
  return std::nullopt;
}

}  // namespace alidade
