// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "opencv-calib/opencv_calibration_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <initializer_list>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "plugin_api/text_file.h"

namespace alidade {

namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t(16) << 20;  // OpenCV's sample stores all corners, too
constexpr int kMaxDepth = 32;

const std::string kAdvice = "Save the calibration with OpenCV's FileStorage, with image_width, image_height, "
                            "camera_matrix and distortion_coefficients";

/// OpenCV's parser calls itself for every level: nothing deep is offered to it. Counts brackets,
/// nested dashes of YAML and open XML elements, whichever the file holds.
bool nestsTooDeep(std::string_view text) {
  int brackets = 0, elements = 0, dashes = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i], next = i + 1 < text.size() ? text[i + 1] : '\0';
    if (c == '[' || c == '{') ++brackets;
    if (c == ']' || c == '}') brackets = std::max(0, brackets - 1);
    if (c == '<' && next == '/') elements -= 2;
    if (c == '<' && (next == '!' || next == '?')) --elements;
    if (c == '<') elements = std::max(0, elements + 1);
    if (c == '-' && (next == ' ' || next == '-')) ++dashes;
    else if (c != ' ' && c != '-') dashes = 0;
    if (brackets > kMaxDepth || elements > kMaxDepth || dashes > kMaxDepth) return true;
  }
  return false;
}

/// The first of the spellings that the file has; an empty node where it has none.
cv::FileNode nodeOf(const cv::FileStorage& storage, std::initializer_list<const char*> spellings) {
  for (const char* key : spellings)
    if (cv::FileNode node = storage[key]; !node.empty() && !node.isNone()) return node;
  return {};
}

struct Matrix {
  int rows = 0, columns = 0;
  std::vector<double> values;
};

Result<std::vector<double>> numbersOf(const cv::FileNode& node, const std::string& key, const std::string& path) {
  std::vector<double> values;
  if (!node.isSeq()) return fail("'" + key + "' holds no list of numbers", path, kAdvice);
  for (const cv::FileNode& item : node) {
    if (item.isSeq()) {  // rows in brackets of their own
      auto row = numbersOf(item, key, path);
      if (!row) return row;
      values.insert(values.end(), row->begin(), row->end());
      continue;
    }
    if (!item.isReal() && !item.isInt()) return fail("'" + key + "' holds something that is no number", path, kAdvice);
    values.push_back(item.real());
    if (!std::isfinite(values.back())) return fail("'" + key + "' holds a number that is not finite", path, "Calibrate the camera again");
  }
  return values;
}

/// An opencv-matrix (rows, cols, data), or a plain list, which is a row.
Result<Matrix> matrixOf(const cv::FileNode& node, const std::string& key, const std::string& path) {
  Matrix matrix;
  auto values = numbersOf(node.isMap() ? node["data"] : node, key, path);
  if (!values) return fail(values.error());
  matrix.values = std::move(*values);
  matrix.rows = 1;
  matrix.columns = static_cast<int>(matrix.values.size());
  if (!node.isMap()) return matrix;
  if (!node["rows"].isInt() || !node["cols"].isInt()) return fail("'" + key + "' has no rows and cols", path, kAdvice);
  matrix.rows = static_cast<int>(node["rows"]);
  matrix.columns = static_cast<int>(node["cols"]);
  if (matrix.rows < 1 || matrix.columns < 1 ||
      std::int64_t(matrix.rows) * matrix.columns != std::int64_t(matrix.values.size()))
    return fail(fmt::format("'{}' says {} × {}, but holds {} numbers", key, matrix.rows, matrix.columns, matrix.values.size()),
                path, kAdvice);
  return matrix;
}

Result<std::array<int, 2>> sizeOf(const cv::FileStorage& storage, const std::string& path) {
  std::array<double, 2> size{};
  const cv::FileNode width = nodeOf(storage, {"image_width", "image_Width", "imageWidth", "width"});
  const cv::FileNode height = nodeOf(storage, {"image_height", "image_Height", "imageHeight", "height"});
  if (const cv::FileNode both = nodeOf(storage, {"image_size", "imageSize"}); width.empty() && height.empty() && !both.empty()) {
    const auto values = numbersOf(both, "image_size", path);
    if (!values) return fail(values.error());
    if (values->size() != 2) return fail("'image_size' is not two numbers", path, kAdvice);
    size = {(*values)[0], (*values)[1]};
  } else {
    if (width.empty()) return fail("'image_width' is missing", path, "Add the width of the pictures in pixels");
    if (height.empty()) return fail("'image_height' is missing", path, "Add the height of the pictures in pixels");
    if (!width.isInt() && !width.isReal()) return fail("'image_width' is no number", path, kAdvice);
    if (!height.isInt() && !height.isReal()) return fail("'image_height' is no number", path, kAdvice);
    size = {width.real(), height.real()};
  }
  const auto possible = [](double v) { return v >= 1 && v <= 1 << 20 && v == std::floor(v); };
  if (!possible(size[0]) || !possible(size[1]))
    return fail(fmt::format("The picture size {} × {} is impossible", size[0], size[1]), path, "Give the size in whole pixels");
  return std::array<int, 2>{static_cast<int>(size[0]), static_cast<int>(size[1])};
}

Result<bool> isFisheye(const cv::FileStorage& storage, const std::string& path) {
  if (const cv::FileNode model = nodeOf(storage, {"distortion_model"}); model.isString()) {
    const std::string name = model.string();
    if (name == "equidistant" || name == "fisheye") return true;
    if (name == "plumb_bob" || name == "rational_polynomial" || name.empty()) return false;
    return fail("The distortion_model " + quotedWords(name) + " is not read", path,
                "Read are plumb_bob, rational_polynomial, equidistant and fisheye");
  }
  const cv::FileNode flag = nodeOf(storage, {"fisheye_model", "fisheye", "is_fisheye"});
  if (flag.empty()) return false;
  if (flag.isInt()) return static_cast<int>(flag) != 0;
  const std::string word = flag.isString() ? lowerCase(flag.string()) : std::string();
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

Result<CameraSet> cameraOf(const cv::FileStorage& storage, const std::string& path) {
  CameraSet set;
  const auto size = sizeOf(storage, path);
  if (!size) return fail(size.error());

  const cv::FileNode matrixNode = nodeOf(storage, {"camera_matrix", "Camera_Matrix", "cameraMatrix", "intrinsic_matrix", "K"});
  if (matrixNode.empty()) return fail("'camera_matrix' is missing", path, kAdvice);
  const auto matrix = matrixOf(matrixNode, "camera_matrix", path);
  if (!matrix) return fail(matrix.error());
  const std::vector<double>& k = matrix->values;
  const bool threeByThree = k.size() == 9 && (matrix->rows == 3 || !matrixNode.isMap());
  if (!threeByThree)
    return fail(fmt::format("'camera_matrix' is {} × {}, not 3 × 3", matrix->rows, matrix->columns), path, kAdvice);
  if (k[3] != 0 || k[6] != 0 || k[7] != 0 || k[8] != 1)
    return fail("'camera_matrix' is no camera matrix: fx 0 cx, 0 fy cy, 0 0 1 is expected", path, kAdvice);
  if (k[1] != 0)
    set.warnings.push_back({fmt::format("The skew {} of 'camera_matrix' is passed over, as OpenCV does", k[1]), path});

  const cv::FileNode lensNode = nodeOf(storage, {"distortion_coefficients", "Distortion_Coefficients", "distCoeffs",
                                                 "dist_coeffs", "distortion", "D"});
  if (lensNode.empty()) return fail("'distortion_coefficients' is missing", path, "Add five zeros for a lens without distortion");
  const auto lens = matrixOf(lensNode, "distortion_coefficients", path);
  if (!lens) return fail(lens.error());
  if (lens->rows != 1 && lens->columns != 1)
    return fail(fmt::format("'distortion_coefficients' is {} × {}, neither a row nor a column", lens->rows, lens->columns), path, kAdvice);
  const auto fisheye = isFisheye(storage, path);
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
  if (nestsTooDeep(text)) return fail("The calibration is nested too deep to be one", path, kAdvice);
  try {
    const std::string_view start = trimmed(text);
    // ROS writes plain YAML, OpenCV insists on its first line.
    const bool plainYaml = !start.starts_with('%') && !start.starts_with('<') && !start.starts_with('{');
    const cv::FileStorage storage(plainYaml ? "%YAML:1.0\n---\n" + text + "\n" : text + "\n",
                                  cv::FileStorage::READ | cv::FileStorage::MEMORY);
    if (!storage.isOpened()) return fail("The calibration cannot be read", path, kAdvice);
    return cameraOf(storage, path);
  } catch (const cv::Exception& error) {
    return fail("The calibration cannot be read: " + error.err, path, kAdvice);
  } catch (const std::exception& error) {
    return fail(std::string("The calibration cannot be read: ") + error.what(), path, kAdvice);
  }
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
