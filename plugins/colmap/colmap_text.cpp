// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <optional>

#include "colmap/colmap_model.h"
#include "plugin_api/text_file.h"

namespace alidade {

namespace {

bool isComment(std::string_view line) { return trimmed(line).starts_with('#'); }

/// IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME
std::optional<ColmapModel::Image> parseImageLine(std::string_view line) {
  FieldReader fields(line);
  ColmapModel::Image image;
  const auto id = fields.integer();
  if (!id) return std::nullopt;
  image.id = *id;
  for (double& value : image.pose) {
    const auto number = fields.number();
    if (!number) return std::nullopt;
    value = *number;
  }
  const auto camera = fields.integer();
  image.name = fields.rest();
  if (!camera || image.name.empty()) return std::nullopt;
  image.camera = *camera;
  return image;
}

/// X Y POINT3D_ID, again and again.
Result<void> parseFeatures(std::string_view line, const std::string& place, ColmapModel& model) {
  FieldReader fields(line);
  std::string_view field;
  while (fields.next(field)) {
    const auto x = parseNumber(field), y = fields.number();
    const bool hasPoint = y && fields.next(field);
    if (!x || !hasPoint || !parseInteger(field))
      return fail("The image's points are no triples of x, y and a point id", place, "Export the model again");
    if (auto added = model.addFeature(*x, *y, place); !added) return added;
  }
  return {};
}

}  // namespace

Result<void> parseColmapCameras(std::string_view text, const std::string& path, ColmapModel& model) {
  LineReader lines(text);
  std::string_view line;
  while (lines.next(line)) {
    if (trimmed(line).empty() || isComment(line)) continue;
    const std::string place = placeInFile(path, lines.number());
    FieldReader fields(line);
    const auto id = fields.integer();
    std::string_view name;
    const bool named = id && fields.next(name);
    const auto width = fields.integer(), height = fields.integer();
    if (!named || !width || !height)
      return fail("The line is no camera: id, model, width, height and parameters are expected", place, "Export the model again as text");
    std::vector<double> parameters;
    for (std::string_view field; fields.next(field);) {
      const auto number = parseNumber(field);
      if (!number) return fail("The camera parameter " + quotedWords(field) + " is no number", place, "Export the model again");
      parameters.push_back(*number);
    }
    if (auto added = model.addCamera(*id, name, *width, *height, std::move(parameters), place); !added) return added;
  }
  return {};
}

Result<void> parseColmapImages(std::string_view text, const std::string& path, bool withFeatures,
                               const Progress& progress, ColmapModel& model) {
  LineReader lines(text);
  std::string_view line;
  bool wantsPoints = false;  // the line after an image's own holds its points, and may be empty
  while (lines.next(line)) {
    if (progress.cancelled()) return fail(cancelledError());
    if (isComment(line)) continue;
    const std::string place = placeInFile(path, lines.number());
    if (wantsPoints) {
      wantsPoints = false;
      if (!parseImageLine(line)) {
        if (!withFeatures) continue;
        if (auto parsed = parseFeatures(line, place, model); !parsed) return parsed;
        continue;
      }
      model.noteImageWithoutPoints(placeInFile(path, lines.number() - 1));
    } else if (trimmed(line).empty()) {
      continue;
    }
    const auto image = parseImageLine(line);
    if (!image)
      return fail("The line is no image: id, four numbers of rotation, three of translation, camera id and name are expected",
                  place, "Export the model again as text");
    if (auto added = model.addImage(*image, place); !added) return added;
    wantsPoints = true;
    progress.report(lines.fraction(), "Reading images.txt");
  }
  return {};
}

Result<void> parseColmapPoints(std::string_view text, const std::string& path, const Progress& progress, ColmapModel& model) {
  LineReader lines(text);
  std::string_view line;
  while (lines.next(line)) {
    if (trimmed(line).empty() || isComment(line)) continue;
    if (lines.number() % 1024 == 0) {
      if (progress.cancelled()) return fail(cancelledError());
      progress.report(lines.fraction(), "Reading points3D.txt");
    }
    const std::string place = placeInFile(path, lines.number());
    FieldReader fields(line);
    bool complete = fields.integer().has_value();
    std::array<double, 3> world{};
    for (double& value : world) {
      const auto number = fields.number();
      complete = complete && number;
      value = number.value_or(0);
    }
    std::array<std::int64_t, 3> colour{};
    for (auto& value : colour) {
      const auto number = fields.integer();
      complete = complete && number;
      value = number.value_or(0);
    }
    if (!complete || !fields.number())
      return fail("The line is no point: id, X, Y, Z, R, G, B, error and track are expected", place, "Export the model again as text");
    if (auto added = model.startPoint(world, colour, place); !added) return added;
    for (std::string_view field; fields.next(field);) {
      const auto image = parseInteger(field), feature = fields.integer();
      if (!image || !feature)
        return fail("The point's track is no list of image and feature numbers", place, "Export the model again as text");
      model.addSighting(*image, *feature, place);
    }
  }
  return {};
}

}  // namespace alidade
