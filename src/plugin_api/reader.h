// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/image.h"
#include "base/progress.h"
#include "camera/camera.h"
#include "survey/design_model.h"
#include "survey/point_batch.h"
#include "survey/point_records.h"
#include "survey/project.h"

namespace alidade {

struct ScanNotes;

/// What a reader reads. A file is offered to every reader; the highest `sniff` wins.
enum class ReaderKind { Scan, Design, Cameras, Pictures, Points };

/// The start of a file (or a folder), for sniffing without opening it again and again.
struct FileProbe {
  std::string path;
  std::string extension;         ///< lower case, without the dot; empty for a folder
  bool isFolder = false;
  std::span<const std::byte> head;  ///< up to 4096 bytes; empty for a folder

  /// True where the head starts with these characters.
  bool startsWith(std::string_view text) const;
  /// True where the head holds these characters.
  bool holds(std::string_view text) const;
};

/// A slip that was tolerated, or something the user should know of the import.
struct ImportWarning {
  std::string what;
  std::string where;
};

struct ReaderDescription {
  std::string id;                       ///< "las"; unique
  std::string name;                     ///< "LAS point cloud"
  std::vector<std::string> extensions;  ///< lower case, without the dot; for file dialogs
};

/// A reader has no state, no dialogs, no globals; every method is thread-safe. Every method returns
/// an Error that names the file and the place; nothing half-read is ever returned, no input crashes
/// or hangs a reader or makes it allocate more than a small multiple of the file's size.
class Reader {
 public:
  virtual ~Reader() = default;
  virtual ReaderKind kind() const = 0;
  virtual ReaderDescription description() const = 0;
  /// 0: not mine. 1-49: by extension or look alone. 50-100: by signature.
  virtual int sniff(const FileProbe& probe) const = 0;
};

/// Takes a run of points. It may take the batch's columns away (swap or move): the reader fills them anew.
/// Returns false to stop early, which is no error.
using BatchSink = std::function<bool(PointBatch& batch)>;

/// Takes a run of points on the thread that made it, on several threads at once. Runs ordered by their numbers stand in
/// the file's order. As a BatchSink it may take the columns away, and stops early with false.
using NumberedSink = std::function<bool(std::uint64_t number, PointBatch& batch)>;

class ScanReader : public Reader {
 public:
  ReaderKind kind() const final { return ReaderKind::Scan; }
  /// From the header alone; no point is loaded.
  virtual Result<ScanInfo> inspect(const std::string& path) const = 0;
  /// What else the header says (survey/scan_notes.h). Here: nothing.
  virtual Result<ScanNotes> notes(const std::string& path) const;
  /// Hands over all points in file order, in batches of at most some 100 k, on the calling thread.
  virtual Result<std::vector<ImportWarning>> read(const std::string& path, const BatchSink& sink,
                                                  const Progress& progress) const = 0;
  /// Whether readAnyOrder uses several threads.
  virtual bool readsAnyOrder() const { return false; }
  /// The same points as `read` in any order: nothing waits for its turn, and nothing goes from one core to another.
  /// Here: as `read`.
  virtual Result<std::vector<ImportWarning>> readAnyOrder(const std::string& path, const NumberedSink& sink,
                                                          const Progress& progress) const;
  /// The same points as the file's own records, for those who need no columns; nothing, and no point handed over, where
  /// records do not tell all that `read` does. Here: nothing.
  virtual Result<std::optional<std::vector<ImportWarning>>> readRecords(const std::string& path, const RecordSink& sink,
                                                                        const Progress& progress) const;
  /// Hands over about `wanted` points taken evenly from the whole file, as fast as the format allows:
  /// for a first picture. Here: every n-th of all points.
  virtual Result<void> sample(const std::string& path, std::uint64_t wanted, const BatchSink& sink,
                              const Progress& progress) const;
};

class DesignReader : public Reader {
 public:
  ReaderKind kind() const final { return ReaderKind::Design; }
  virtual Result<DesignInfo> inspect(const std::string& path) const = 0;
  virtual Result<DesignModel> read(const std::string& path, const Progress& progress,
                                   std::vector<ImportWarning>& warnings) const = 0;
};

/// A picture's name with the pose and the camera that a file gives it.
struct PosedPicture {
  std::string name;            ///< file name as the source writes it; empty for a bare trajectory
  double timeSecs = 0;         ///< valid where hasTime
  bool hasTime = false;
  int camera = -1;             ///< index into CameraSet::cameras; -1 where the file has none
  std::optional<RigidTransform> cameraFromWorld;
};

/// A surveyed or reconstructed point that a camera file carries (COLMAP points3D), with where it was seen.
struct TiePoint {
  glm::dvec3 world{0};
  Rgba8 colour;
  std::vector<std::pair<int, glm::dvec2>> seenIn;  ///< index into CameraSet::pictures, pixel (OpenCV's origin)
};

/// Cameras, poses, or both. Everything in Alidade's conventions: OpenCV axes and pixel origin.
struct CameraSet {
  std::vector<Intrinsics> cameras;
  /// Indices of cameras whose file states no picture size (Bundler, BAL): they have the smallest size that
  /// holds the observations, and its middle as principal point. Whoever knows a picture centres them on it.
  std::vector<int> camerasWithoutSize;
  std::vector<PosedPicture> pictures;  ///< in file order
  std::vector<TiePoint> tiePoints;
  std::string details;
  std::vector<ImportWarning> warnings;
};

class CameraReader : public Reader {
 public:
  ReaderKind kind() const final { return ReaderKind::Cameras; }
  /// Camera files are small: inspect reads all but the tie points.
  virtual Result<CameraSet> inspect(const std::string& path) const = 0;
  virtual Result<CameraSet> read(const std::string& path, const Progress& progress) const = 0;
};

struct PictureInfo {
  std::string name;  ///< "00003.png", "frame 12"
  std::string path;  ///< of the picture file; of the video for its frames
  double timeSecs = 0;
};

struct PictureSetInfo {
  bool isVideo = false;        ///< the pictures are no files of their own: a video, or a scan that carries them
  int width = 0, height = 0;   ///< of the first picture
  double framesPerSecond = 0;  ///< 0 for a folder of pictures
  std::vector<PictureInfo> pictures;
  std::string details;
};

/// Decoded pictures of one set, in any order. Not thread-safe: one user at a time.
class PictureSource {
 public:
  virtual ~PictureSource() = default;
  virtual Result<ColourImage> picture(std::size_t index) = 0;
};

class PictureReader : public Reader {
 public:
  ReaderKind kind() const final { return ReaderKind::Pictures; }
  virtual Result<PictureSetInfo> inspect(const std::string& path) const = 0;
  virtual Result<std::unique_ptr<PictureSource>> open(const std::string& path) const = 0;
};

struct PointList {
  std::vector<StakePoint> points;
  std::vector<ImportWarning> warnings;
};

/// Stake-out and control points.
class PointListReader : public Reader {
 public:
  ReaderKind kind() const final { return ReaderKind::Points; }
  virtual Result<PointList> read(const std::string& path) const = 0;
};

}  // namespace alidade
