# Several files of a target compiled as one, no more than `limit`: half of what a file costs is what its neighbours say
# as well. A file's batch comes from its name, and a new file moves no other into another's batch; names in the
# anonymous namespaces of a batch differ. Builds for developers compile every file alone, so that none lives on
# another's includes.
function(palpate_in_batches target limit)
    if(NOT PALPATE_BATCHES)
        return()
    endif()
    get_target_property(sources ${target} SOURCES)
    list(FILTER sources EXCLUDE REGEX "TARGET_OBJECTS|^/")
    list(LENGTH sources count)
    set(batches 1)
    while(count GREATER limit)
        math(EXPR batches "2 * ${batches}")
        math(EXPR count "(${count} + 1) / 2")
    endwhile()
    foreach(source ${sources})
        get_filename_component(name ${source} NAME_WE)
        string(MD5 hash ${name})
        string(SUBSTRING ${hash} 0 4 hash)
        math(EXPR batch "0x${hash} % ${batches}")
        set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${batch})
    endforeach()
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    # What a batch is warned of beside its files: that each of them is no file of its own, and what g++ 12 makes of
    # more functions at once.
    target_compile_options(${target} PRIVATE
        $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage -Wno-maybe-uninitialized -Wno-stringop-overflow -Wno-array-bounds>)
endfunction()

# A room is a list of folders, each a target of its own.
#
#   palpate_folder(contact SEES geometry math SOURCES closest_point.cpp ...)
#
# SEES names the folders of the same room that this one includes: those above it in the list, and no other.
# Rooms to the left are open to all. The guard of the architecture reads the same words, and compares them
# with every #include.
#
# LINK    libraries of its own
# PLAIN   reads, writes and waits: less optimised, it compiles in half of the time, and nobody sees a
#         difference
# PACED   what the tests wait for under sanitizers: optimised there as well
# ALONE   every file is compiled alone: the speed of a tick must not depend on who its neighbour is, and a mutant
#         takes the place of one file
# MUTATED of another folder, these files are
# TICKED  of a PLAIN folder, these files go over every tick or search an optimum, and are optimised all the same
function(palpate_folder folder)
    cmake_parse_arguments(PARSE_ARGV 1 arg "PLAIN;PACED;ALONE" "" "SEES;SOURCES;LINK;MUTATED;TICKED")
    get_filename_component(room ${CMAKE_CURRENT_SOURCE_DIR} NAME)
    string(REPLACE "/" "_" name ${room}_${folder})
    string(REPLACE "/" "_" seen "${arg_SEES}")
    list(TRANSFORM seen PREPEND palpate::${room}_)
    if(NOT arg_SOURCES)
        add_library(palpate_${name} INTERFACE)
        add_library(palpate::${name} ALIAS palpate_${name})
        target_link_libraries(palpate_${name} INTERFACE palpate::${room}_left ${seen})
        return()
    endif()
    list(TRANSFORM arg_SOURCES PREPEND ${folder}/)
    list(TRANSFORM arg_MUTATED PREPEND ${folder}/)
    list(TRANSFORM arg_TICKED PREPEND ${folder}/)
    set_source_files_properties(${arg_MUTATED} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    set(parts ${name})
    if(arg_TICKED)
        list(REMOVE_ITEM arg_SOURCES ${arg_TICKED})
        palpate_part(${name}_ticked "" "${arg_TICKED}")
        list(APPEND parts ${name}_ticked)
    endif()
    palpate_part(${name} "${arg_PLAIN}" "${arg_SOURCES}")
    add_library(palpate::${name} ALIAS palpate_${name})
    foreach(part ${parts})
        target_link_libraries(palpate_${part}
            PUBLIC palpate::${room}_left ${seen} PRIVATE ${arg_LINK} palpate::warnings)
        if(arg_PACED AND PALPATE_SANITIZE)
            target_compile_options(palpate_${part} PRIVATE -O2)
        endif()
        if(arg_ALONE)
            # No stranger's bytes come here. (The macro is of the flags that the precompiled header was made with.)
            if(NOT PALPATE_SANITIZE)
                target_compile_options(palpate_${part} PRIVATE -fno-stack-protector -D__SSP_STRONG__=3)
            endif()
        else()
            palpate_in_batches(palpate_${part} 24)
        endif()
        set_property(GLOBAL APPEND PROPERTY palpate_${room}_objects $<TARGET_OBJECTS:palpate_${part}>)
    endforeach()
    set_property(GLOBAL APPEND PROPERTY palpate_${room}_libraries ${arg_LINK})
endfunction()

# Files of a folder that are optimised alike. What most files include is parsed once for those that are optimised and
# once for the plain ones: g++ 12 optimises what stands behind a precompiled header as it did the header itself.
function(palpate_part name plain sources)
    add_library(palpate_${name} OBJECT ${sources})
    set(headers palpate_headers)
    if(plain AND CMAKE_BUILD_TYPE STREQUAL "Release")
        target_compile_options(palpate_${name} PRIVATE -Og)
        set(headers palpate_plain_headers)
    endif()
    get_property(made GLOBAL PROPERTY ${headers})
    if(NOT made)
        target_precompile_headers(palpate_${name} PRIVATE
            <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <map> <memory> <optional> <span>
            <stdexcept> <string> <string_view> <utility> <vector> <fmt/format.h> <glm/geometric.hpp>)
        set_property(GLOBAL PROPERTY ${headers} palpate_${name})
    elseif("Eigen3::Eigen" IN_LIST arg_LINK AND CMAKE_BUILD_TYPE STREQUAL "Debug" AND NOT PALPATE_SANITIZE)
        # Behind one, g++ 12 without optimisation refuses the intrinsics that Eigen prefetches by.
    else()
        target_precompile_headers(palpate_${name} REUSE_FROM ${made})
    endif()
endfunction()

# What every folder of this room may use: the rooms to the left, and libraries whose values are part of our own
# interfaces. Before its folders.
function(palpate_room_uses)
    get_filename_component(room ${CMAKE_CURRENT_SOURCE_DIR} NAME)
    add_library(palpate_${room}_left INTERFACE)
    add_library(palpate::${room}_left ALIAS palpate_${room}_left)
    target_link_libraries(palpate_${room}_left INTERFACE ${ARGN})
endfunction()

# All folders of this room as one library. After its folders.
function(palpate_room)
    get_filename_component(room ${CMAKE_CURRENT_SOURCE_DIR} NAME)
    get_property(objects GLOBAL PROPERTY palpate_${room}_objects)
    get_property(libraries GLOBAL PROPERTY palpate_${room}_libraries)
    list(REMOVE_DUPLICATES libraries)
    add_library(palpate_${room} STATIC ${objects})
    add_library(palpate::${room} ALIAS palpate_${room})
    target_link_libraries(palpate_${room} PUBLIC palpate::${room}_left PRIVATE ${libraries})
endfunction()
