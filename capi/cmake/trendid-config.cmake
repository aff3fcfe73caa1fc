# `find_package(trendid)` of a release archive: no Rust needed.
if(NOT DEFINED TRENDID_TARGET)
    include(${CMAKE_CURRENT_LIST_DIR}/trendid-target.cmake)
endif()
set(TRENDID_VARIANT "fast" CACHE STRING "fast (-O3) or small (-Os)")
get_filename_component(trendid_ROOT_DIR ${CMAKE_CURRENT_LIST_DIR}/../../.. ABSOLUTE)
set(trendid_LIBRARY ${trendid_ROOT_DIR}/lib/${TRENDID_TARGET}/${TRENDID_VARIANT}/libtrendid.a)
if(NOT EXISTS ${trendid_LIBRARY})
    set(trendid_FOUND FALSE)
    set(trendid_NOT_FOUND_MESSAGE "this archive has no ${trendid_LIBRARY}")
    return()
endif()
if(NOT TARGET trendid::trendid)
    add_library(trendid::trendid STATIC IMPORTED)
    set_target_properties(trendid::trendid PROPERTIES
        IMPORTED_LOCATION ${trendid_LIBRARY}
        INTERFACE_INCLUDE_DIRECTORIES ${trendid_ROOT_DIR}/include
        INTERFACE_LINK_OPTIONS -Wl,--gc-sections)
endif()
set(trendid_FOUND TRUE)
