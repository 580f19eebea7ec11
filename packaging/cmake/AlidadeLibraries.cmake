# SPDX-FileCopyrightText: 2026 the Alidade authors
# SPDX-License-Identifier: BSD-3-Clause
# Third-party libraries, each found once here and linked only by its owner folder.

find_package(Threads REQUIRED)
find_package(Qt6 6.4 REQUIRED COMPONENTS Core Gui Widgets Sql Svg OpenGL OpenGLWidgets Test)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(tl-expected REQUIRED)
find_package(glm REQUIRED)
find_package(Eigen3 REQUIRED)
find_package(Ceres 2.1 REQUIRED)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(Vulkan REQUIRED)
find_package(OpenCV 4.5 REQUIRED COMPONENTS core imgproc calib3d imgcodecs features2d video videoio aruco)
find_package(assimp REQUIRED)
find_package(embree 3 REQUIRED)
find_package(GTest REQUIRED)
find_package(benchmark REQUIRED)
find_package(PNG REQUIRED)
find_package(CURL REQUIRED)
find_package(PROJ REQUIRED)
find_package(pugixml REQUIRED)
find_package(hwy REQUIRED)

# Never GUISupportQt: Debian's is built on Qt 5.
find_package(VTK 9.1 REQUIRED COMPONENTS
  CommonCore CommonDataModel CommonExecutionModel FiltersCore FiltersSources InteractionStyle
  InteractionWidgets RenderingAnnotation RenderingCore RenderingFreeType RenderingOpenGL2 RenderingUI)

find_library(IFCPP_LIBRARY NAMES IfcPlusPlus REQUIRED)

# PCL's own package configuration asks for every library that some part of it may use.
find_path(PCL_INCLUDE pcl/point_cloud.h PATH_SUFFIXES pcl-1.13 pcl-1.14 pcl REQUIRED)
set(PCL_LIBRARIES)
foreach(part common kdtree search features filters sample_consensus segmentation surface)
  find_library(PCL_${part}_LIBRARY NAMES pcl_${part} REQUIRED)
  list(APPEND PCL_LIBRARIES ${PCL_${part}_LIBRARY})
endforeach()
