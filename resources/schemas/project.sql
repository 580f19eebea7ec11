-- SPDX-FileCopyrightText: 2026 the Alidade authors
-- SPDX-License-Identifier: BSD-3-Clause
--
-- The project file, version 6 (PRAGMA user_version; application_id is "ALID"). Lengths are metres in
-- the project's own system (E, N, up), angles radians, times seconds, pixels have OpenCV's origin.
-- `position` keeps the order of a list from 0. Numbers without a type keep every bit of a double: a
-- REAL column would turn -0.0 into 0. NULL in such a column is NaN. Text that is not UTF-8 is a blob.
-- Poses read p_camera = q * p_world + t.

CREATE TABLE project (
  name, crs
);

-- level_threshold since version 4.
CREATE TABLE display (
  image_pass, depth_pass, design_pass, point_pass,
  density, density_law, points_per_square_metre, level_threshold, point_size, round_points,
  hidden, design_opacity, design_edges, design_faces, grayscale_image, grayscale_design,
  light_x, light_y, light_z, ambient, diffuse, specular, shininess,
  stake_points, annotations, labels,
  residual_scale, subdivision_error_px,
  depth_tolerance_m
);

-- Since version 2. hidden_classes: ASPRS codes between blanks.
CREATE TABLE point_style (
  colour_by, ramp, automatic_range, range_low, range_high, hidden_classes,
  box_on, box_e, box_n, box_h, box_size_x, box_size_y, box_size_z, box_heading_rad,
  section_on, section_e, section_n, section_h, section_azimuth_rad, section_elevation_rad, section_thickness_m,
  size_law, eye_dome, eye_dome_strength
);

-- Since version 6: the planes that cut points off; what lies on the side of their normal goes.
CREATE TABLE point_cut (
  position INTEGER PRIMARY KEY, is_on, e, n, h, azimuth_rad, elevation_rad
);

-- A source's path is relative to the project file; size in bytes; hash as io/project_store.h says.
CREATE TABLE scan (
  position INTEGER PRIMARY KEY, id, name, source_path, source_size, source_hash, visible,
  point_count, bounds_min_e, bounds_min_n, bounds_min_h, bounds_max_e, bounds_max_n, bounds_max_h,
  crs, scale_e, scale_n, scale_h, details
);

CREATE TABLE scan_attribute (
  position INTEGER PRIMARY KEY, scan, name
);

CREATE TABLE scan_station (
  position INTEGER PRIMARY KEY, scan, name, qw, qx, qy, qz, te, tn, th, grid_rows, grid_columns
);

CREATE TABLE design (
  position INTEGER PRIMARY KEY, id, name, source_path, source_size, source_hash, visible
);

CREATE TABLE design_hidden_element (
  position INTEGER PRIMARY KEY, design, global_id
);

CREATE TABLE camera (
  position INTEGER PRIMARY KEY, id, name, model, width, height, fx, fy, cx, cy,
  k1, k2, k3, k4, k5, k6, q1, q2, q3, p1, p2, t3, t4, t5, t6, s1, s2, s3, s4,
  shear, skew, tau_x, tau_y, fisheye
);

CREATE TABLE video (
  position INTEGER PRIMARY KEY, id, name, source_path, source_size, source_hash,
  frames_per_second, frame_count
);

-- Since version 5: where cameras sit on the body that carries them.
CREATE TABLE camera_mount (
  position INTEGER PRIMARY KEY, camera, body, qw, qx, qy, qz, tx, ty, tz,
  std_tx_m, std_ty_m, std_tz_m, std_x_rad, std_y_rad, std_z_rad
);

-- Since version 3: cameras that read row by row, videos whose times are not the container's, trajectories with
-- their clocks (pose clock minus picture clock) and the frames that they serve. `camera`, `video`, `frame` and
-- trajectory_pose.trajectory are positions, frame_trajectory.trajectory is an id.
CREATE TABLE camera_shutter (
  position INTEGER PRIMARY KEY, camera, readout_s
);

CREATE TABLE video_timing (
  position INTEGER PRIMARY KEY, video, timing
);

CREATE TABLE trajectory (
  position INTEGER PRIMARY KEY, id, name, source_path, source_size, source_hash,
  clock_offset_s, has_clock_offset_std, clock_offset_std_s
);

CREATE TABLE trajectory_pose (
  position INTEGER PRIMARY KEY, trajectory, time_s, qw, qx, qy, qz, tx, ty, tz
);

CREATE TABLE frame_trajectory (
  position INTEGER PRIMARY KEY, frame, trajectory
);

CREATE TABLE frame (
  position INTEGER PRIMARY KEY, id, name, time_s, camera, image_path, image_size, image_hash,
  video, video_frame,
  has_pose, qw, qx, qy, qz, tx, ty, tz,
  has_original_pose, original_qw, original_qx, original_qy, original_qz,
  original_tx, original_ty, original_tz,
  pose_source,
  has_quality, rms_px, sigma0, std_e_m, std_n_m, std_h_m, std_x_rad, std_y_rad, std_z_rad,
  quality_observations
);

CREATE TABLE stake_point (
  position INTEGER PRIMARY KEY, name, e, n, h, code, tolerance_m
);

CREATE TABLE control_point (
  position INTEGER PRIMARY KEY, name, e, n, h, sigma_m
);

CREATE TABLE observation (
  position INTEGER PRIMARY KEY, id, frame, kind, u_px, v_px, e, n, h, e2, n2, h2, depth_m, sigma_px, sigma_m, name,
  enabled, held_out
);

CREATE TABLE annotation (
  position INTEGER PRIMARY KEY, id, kind, anchor, text, frame, e, n, h, u_px, v_px,
  offset_u_px, offset_v_px, red, green, blue, alpha
);

CREATE TABLE finding (
  position INTEGER PRIMARY KEY, id, name, text, element_global_id, e, n, h, deviation_m
);
