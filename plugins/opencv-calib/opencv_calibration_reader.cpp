// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "opencv-calib/opencv_calibration_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>

#include <fmt/format.h>

#include "opencv-calib/calibration_fields.h"
#include "plugin_api/text_file.h"

namespace alidade {

namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t(16) << 20;  // OpenCV's sample stores all corners, too

const std::string kAdvice = "Save the calibration with OpenCV's FileStorage, with image_width, image_height, "
                            "camera_matrix and distortion_coefficients";

/// The first of the spellings that the file has; empty where it has none.
std::string keyOf(const TextFields& fields, std::initializer_list<const char*> spellings) {
  for (const char* key : spellings)
    if (fields.contains(key) || fields.contains(std::string(key).append(".data"))) return key;
  return {};
}

std::string textOf(const TextFields& fields, const std::string& key) {
  const auto found = fields.find(key);
  return found == fields.end() ? std::string() : found->second;
}

struct Matrix {
  int rows = 0, columns = 0;
  bool hasShape = false;
  std::vector<double> values;
};

bool isNotFinite(std::string_view word) {
  const std::string lower = lowerCase(word);
  return lower.ends_with("nan") || lower.ends_with("inf");
}

Result<std::vector<double>> numbersOf(std::string text, const std::string& key, const std::string& path) {
  for (char& c : text)
    if (c == '[' || c == ']' || c == ',' || c == '"') c = ' ';
  std::vector<double> values;
  FieldReader fields(text);
  for (std::string_view word; fields.next(word);) {
    if (word == "-") continue;  // YAML's list mark
    const auto number = parseNumber(word);
    if ((number && !std::isfinite(*number)) || (!number && isNotFinite(word)))
      return fail("'" + key + "' holds a number that is not finite", path, "Calibrate the camera again");
    if (!number) return fail("'" + key + "' holds something that is no number: " + quotedWords(word), path, kAdvice);
    values.push_back(*number);
  }
  return values;
}

/// An opencv-matrix (rows, cols, data), or a plain list, which is a row.
Result<Matrix> matrixOf(const TextFields& fields, const std::string& spelling, const std::string& key, const std::string& path) {
  Matrix matrix;
  matrix.hasShape = fields.contains(spelling + ".data");
  auto values = numbersOf(textOf(fields, matrix.hasShape ? spelling + ".data" : spelling), key, path);
  if (!values) return fail(values.error());
  if (values->empty()) return fail("'" + key + "' holds no numbers", path, kAdvice);
  matrix.values = std::move(*values);
  matrix.rows = 1;
  matrix.columns = static_cast<int>(matrix.values.size());
  if (!matrix.hasShape) return matrix;
  const auto rows = parseInteger(textOf(fields, spelling + ".rows")), columns = parseInteger(textOf(fields, spelling + ".cols"));
  if (!rows || !columns) return fail("'" + key + "' has no rows and cols", path, kAdvice);
  const auto count = static_cast<std::int64_t>(matrix.values.size());
  if (*rows < 1 || *columns < 1 || *rows > count || *columns > count || *rows * *columns != count)
    return fail(fmt::format("'{}' says {} × {}, but holds {} numbers", key, *rows, *columns, count), path, kAdvice);
  matrix.rows = static_cast<int>(*rows);
  matrix.columns = static_cast<int>(*columns);
  return matrix;
}

Result<std::array<int, 2>> sizeOf(const TextFields& fields, const std::string& path) {
  std::array<double, 2> size{};
  const std::string width = keyOf(fields, {"image_width", "image_Width", "imageWidth", "width"});
  const std::string height = keyOf(fields, {"image_height", "image_Height", "imageHeight", "height"});
  if (const std::string both = keyOf(fields, {"image_size", "imageSize"}); width.empty() && height.empty() && !both.empty()) {
    const auto values = numbersOf(textOf(fields, both), "image_size", path);
    if (!values) return fail(values.error());
    if (values->size() != 2) return fail("'image_size' is not two numbers", path, kAdvice);
    size = {(*values)[0], (*values)[1]};
  } else {
    if (width.empty()) return fail("'image_width' is missing", path, "Add the width of the pictures in pixels");
    if (height.empty()) return fail("'image_height' is missing", path, "Add the height of the pictures in pixels");
    const auto w = parseNumber(textOf(fields, width)), h = parseNumber(textOf(fields, height));
    if (!w) return fail("'image_width' is no number", path, kAdvice);
    if (!h) return fail("'image_height' is no number", path, kAdvice);
    size = {*w, *h};
  }
  const auto possible = [](double v) { return v >= 1 && v <= 1 << 20 && v == std::floor(v); };
  if (!possible(size[0]) || !possible(size[1]))
    return fail(fmt::format("The picture size {} × {} is impossible", size[0], size[1]), path, "Give the size in whole pixels");
  return std::array<int, 2>{static_cast<int>(size[0]), static_cast<int>(size[1])};
}

Result<bool> isFisheye(const TextFields& fields, const std::string& path) {
  if (const std::string name = textOf(fields, "distortion_model"); !name.empty()) {
    if (name == "equidistant" || name == "fisheye") return true;
    if (name == "plumb_bob" || name == "rational_polynomial") return false;
    return fail("The distortion_model " + quotedWords(name) + " is not read", path,
                "Read are plumb_bob, rational_polynomial, equidistant and fisheye");
  }
  const std::string flag = keyOf(fields, {"fisheye_model", "fisheye", "is_fisheye"});
  if (flag.empty()) return false;
  const std::string word = lowerCase(textOf(fields, flag));
  if (word == "true" || word == "1") return true;
  if (word == "false" || word == "0") return false;
  return fail("'fisheye_model' is neither 0 nor 1", path, kAdvice);
}

Result<CameraModel> modelOf(std::size_t coefficients, bool fisheye, const std::string& path) {
  if (fisheye) {
    if (coefficients == 4) return CameraModel::OpenCvFisheye;
    return fail(fmt::format("'distortion_coefficients' of a fisheye lens holds {} numbers, not 4", coefficients), path, kAdvice);
  }
  switch (coefficients) {
    case 4: return CameraModel::OpenCv4;
    case 5: return CameraModel::OpenCv5;
    case 8: return CameraModel::OpenCv8;
    case 12: return CameraModel::OpenCv12;
    case 14: return CameraModel::OpenCv14;
    default:
      return fail(fmt::format("'distortion_coefficients' holds {} numbers, not 4, 5, 8, 12 or 14", coefficients), path, kAdvice);
  }
}

Result<CameraSet> cameraOf(const TextFields& fields, const std::string& path) {
  CameraSet set;
  const auto size = sizeOf(fields, path);
  if (!size) return fail(size.error());

  const std::string matrixKey = keyOf(fields, {"camera_matrix", "Camera_Matrix", "cameraMatrix", "intrinsic_matrix", "K"});
  if (matrixKey.empty()) return fail("'camera_matrix' is missing", path, kAdvice);
  const auto matrix = matrixOf(fields, matrixKey, "camera_matrix", path);
  if (!matrix) return fail(matrix.error());
  const std::vector<double>& k = matrix->values;
  const bool threeByThree = k.size() == 9 && (matrix->rows == 3 || !matrix->hasShape);
  if (!threeByThree)
    return fail(fmt::format("'camera_matrix' is {} × {}, not 3 × 3", matrix->rows, matrix->columns), path, kAdvice);
  if (k[3] != 0 || k[6] != 0 || k[7] != 0 || k[8] != 1)
    return fail("'camera_matrix' is no camera matrix: fx 0 cx, 0 fy cy, 0 0 1 is expected", path, kAdvice);
  if (k[1] != 0)
    set.warnings.push_back({fmt::format("The skew {} of 'camera_matrix' is passed over, as OpenCV does", k[1]), path});

  const std::string lensKey = keyOf(fields, {"distortion_coefficients", "Distortion_Coefficients", "distCoeffs",
                                                 "dist_coeffs", "distortion", "D"});
  if (lensKey.empty()) return fail("'distortion_coefficients' is missing", path, "Add five zeros for a lens without distortion");
  const auto lens = matrixOf(fields, lensKey, "distortion_coefficients", path);
  if (!lens) return fail(lens.error());
  if (lens->rows != 1 && lens->columns != 1)
    return fail(fmt::format("'distortion_coefficients' is {} × {}, neither a row nor a column", lens->rows, lens->columns), path, kAdvice);
  const auto fisheye = isFisheye(fields, path);
  if (!fisheye) return fail(fisheye.error());
  const auto model = modelOf(lens->values.size(), *fisheye, path);
  if (!model) return fail(model.error());

  std::vector<double> parameters = {k[0], k[4], k[2], k[5]};
  parameters.insert(parameters.end(), lens->values.begin(), lens->values.end());
  const auto intrinsics = Intrinsics::fromParameters(*model, (*size)[0], (*size)[1], parameters);
  if (!intrinsics) return fail(intrinsics.error().in(path));
  if (auto valid = intrinsics->validate(); !valid) return fail(valid.error().in(path));
  set.cameras.push_back(*intrinsics);
  set.details = fmt::format("OpenCV calibration: {} × {}, {}", (*size)[0], (*size)[1], cameraModelName(*model));
  return set;
}

}  // namespace

Result<CameraSet> parseOpenCvCalibration(const std::string& text, const std::string& path) {
  if (trimmed(text).empty()) return fail("The calibration file is empty", path, kAdvice);
  if (text.find('\0') != std::string::npos) return fail("The calibration is no text file", path, kAdvice);
  const auto fields = parseCalibrationFields(text, path);
  if (!fields) return fail(fields.error());
  return cameraOf(*fields, path);
}

ReaderDescription OpenCvCalibrationReader::description() const {
  return {"opencv-calibration", "OpenCV calibration", {"yml", "yaml", "xml", "json"}};
}

int OpenCvCalibrationReader::sniff(const FileProbe& probe) const {
  if (probe.isFolder) return 0;
  const bool named = probe.holds("amera_matrix") || probe.holds("amera_Matrix") || probe.holds("cameraMatrix");
  const bool opencv = probe.startsWith("%YAML") || probe.holds("<opencv_storage");
  const auto extensions = description().extensions;
  const bool extension = std::find(extensions.begin(), extensions.end(), probe.extension) != extensions.end();
  if (opencv) return named ? 90 : 55;
  // The matrix may stand beyond the head, after all the corners.
  return named && extension ? 70 : probe.extension == "yml" || probe.extension == "yaml" ? 20 : 0;
}

Result<CameraSet> OpenCvCalibrationReader::inspect(const std::string& path) const { return read(path, Progress()); }

Result<CameraSet> OpenCvCalibrationReader::read(const std::string& path, const Progress&) const {
  const auto text = readTextFile(path, kMaxBytes);
  if (!text) return fail(text.error());
  return parseOpenCvCalibration(*text, path);
}

}  // namespace alidade
