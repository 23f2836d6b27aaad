# OpenVDB::openvdb from its header and its library. The module that OpenVDB installs wants CMake files of boost that Debian's
# development package does not need.
find_path(OpenVDB_INCLUDE_DIR openvdb/openvdb.h)
find_path(OpenVDB_BOOST_INCLUDE_DIR boost/numeric/conversion/conversion_traits.hpp)
find_path(OpenVDB_IMATH_INCLUDE_DIR half.h PATH_SUFFIXES Imath)
find_library(OpenVDB_LIBRARY openvdb)
mark_as_advanced(OpenVDB_INCLUDE_DIR OpenVDB_BOOST_INCLUDE_DIR OpenVDB_IMATH_INCLUDE_DIR OpenVDB_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenVDB
  REQUIRED_VARS OpenVDB_LIBRARY OpenVDB_INCLUDE_DIR OpenVDB_BOOST_INCLUDE_DIR OpenVDB_IMATH_INCLUDE_DIR)

if(OpenVDB_FOUND AND NOT TARGET OpenVDB::openvdb)
  add_library(OpenVDB::openvdb UNKNOWN IMPORTED)
  # Headers of imported targets are system headers, whose warnings are not ours.
  set_target_properties(OpenVDB::openvdb PROPERTIES
    IMPORTED_LOCATION ${OpenVDB_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES "${OpenVDB_INCLUDE_DIR};${OpenVDB_BOOST_INCLUDE_DIR};${OpenVDB_IMATH_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES TBB::tbb)
endif()
