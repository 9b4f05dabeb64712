# find_package(rosetta_jit): the headers that generated C++ shares, and a function that generates sources.
#
#   rosetta_generate(TARGET SUBJECT [LANGUAGE c|cpp] [HOLDER own|protobuf|ros1|ros2|lcm|yarp|rsb] [ENCODING NAME] [NAME NAME]
#                    [FRAMEWORK NAME] [INCLUDE HEADER] [BYTE_ORDER little|big] [WIRE NAME] [DIRECTIONS decode|encode...]
#                    [LENIENT NAME...] [PARAMETERS NAME=VALUE...] [IMPORTS FILE...] [DEPENDS FILE...])
#
# writes SUBJECT, a mapping (*.mapping) or a type, as source, and adds it to TARGET. Whoever links TARGET finds its header, `NAME.hpp` or
# `NAME.h`. NAME is by default the name of the mapping's file; a type needs one, and IMPORTS, the files that declare it, where its name does
# not tell. When the mapping changes, or a file in IMPORTS or DEPENDS, the source is written anew.

cmake_minimum_required(VERSION 3.13)

get_filename_component(ROSETTA_JIT_PACKAGE "${CMAKE_CURRENT_LIST_DIR}/../.." ABSOLUTE)
find_program(ROSETTA_JIT_EXECUTABLE rosetta-jit HINTS "${ROSETTA_JIT_PACKAGE}/../../../../bin" DOC "the command line of rosetta_jit")
if(NOT ROSETTA_JIT_EXECUTABLE)
  set(rosetta_jit_FOUND FALSE)
  set(rosetta_jit_NOT_FOUND_MESSAGE "rosetta-jit is not on the path; set ROSETTA_JIT_EXECUTABLE")
  return()
endif()

if(NOT TARGET rosetta_jit::headers)
  add_library(rosetta_jit::headers INTERFACE IMPORTED)
  set_target_properties(rosetta_jit::headers PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${ROSETTA_JIT_PACKAGE}/generate/cpp/include")
endif()

function(rosetta_generate target subject)
  cmake_parse_arguments(PARSE_ARGV 2 ARG "" "LANGUAGE;HOLDER;ENCODING;NAME;FRAMEWORK;INCLUDE;BYTE_ORDER;WIRE"
                        "DIRECTIONS;LENIENT;PARAMETERS;IMPORTS;DEPENDS")
  if(ARG_UNPARSED_ARGUMENTS OR ARG_KEYWORDS_MISSING_VALUES)
    message(FATAL_ERROR "rosetta_generate: cannot use ${ARG_UNPARSED_ARGUMENTS}${ARG_KEYWORDS_MISSING_VALUES}")
  endif()
  if(NOT ARG_LANGUAGE)
    set(ARG_LANGUAGE cpp)
  endif()
  if(NOT ARG_LANGUAGE MATCHES "^(c|cpp)$")
    message(FATAL_ERROR "rosetta_generate: LANGUAGE is c or cpp, not ${ARG_LANGUAGE}")
  endif()
  set(depends ${ARG_DEPENDS})
  if(subject MATCHES "\\.mapping$")
    get_filename_component(file "${subject}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_SOURCE_DIR}")
    if(EXISTS "${file}") # else it is one that the library brings
      set(subject "${file}")
      list(APPEND depends "${file}")
    endif()
    if(NOT ARG_NAME)
      get_filename_component(ARG_NAME "${subject}" NAME_WE)
      string(REGEX REPLACE "[^A-Za-z0-9_]+" "_" ARG_NAME "${ARG_NAME}")
    endif()
  elseif(NOT ARG_NAME)
    message(FATAL_ERROR "rosetta_generate: ${subject} is a type, and needs a NAME")
  endif()
  if(NOT ARG_DIRECTIONS)
    set(ARG_DIRECTIONS decode encode)
  endif()
  list(JOIN ARG_DIRECTIONS "," directions)

  set(options --language ${ARG_LANGUAGE} --name ${ARG_NAME} --directions ${directions})
  foreach(option HOLDER ENCODING FRAMEWORK INCLUDE BYTE_ORDER WIRE)
    if(ARG_${option})
      string(TOLOWER ${option} flag)
      string(REPLACE _ - flag ${flag})
      list(APPEND options --${flag} ${ARG_${option}})
    endif()
  endforeach()
  foreach(name IN LISTS ARG_LENIENT)
    list(APPEND options --lenient ${name})
  endforeach()
  foreach(parameter IN LISTS ARG_PARAMETERS)
    list(APPEND options --parameter ${parameter})
  endforeach()

  foreach(import IN LISTS ARG_IMPORTS)
    get_filename_component(file "${import}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_SOURCE_DIR}")
    if(EXISTS "${file}") # else it is one that the library brings, or on the search path
      set(import "${file}")
      list(APPEND depends "${file}")
    endif()
    list(APPEND options --import "${import}")
  endforeach()

  set(folder "${CMAKE_CURRENT_BINARY_DIR}/rosetta_jit/${target}")
  if(ARG_LANGUAGE STREQUAL "c")
    set(files "${folder}/${ARG_NAME}.h" "${folder}/${ARG_NAME}.c")
  else()
    set(files "${folder}/${ARG_NAME}.hpp" "${folder}/${ARG_NAME}.cpp")
  endif()
  add_custom_command(
    OUTPUT ${files}
    COMMAND "${CMAKE_COMMAND}" -E remove -f ${files} # else the command keeps them where SUBJECT has become another one
    COMMAND "${ROSETTA_JIT_EXECUTABLE}" generate "${subject}" ${options} --output "${folder}"
    DEPENDS ${depends}
    WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}"
    COMMENT "Generating ${ARG_NAME} from ${subject}"
    VERBATIM)
  target_sources(${target} PRIVATE ${files})
  target_include_directories(${target} PUBLIC "$<BUILD_INTERFACE:${folder}>")
  if(ARG_LANGUAGE STREQUAL "cpp")
    target_compile_features(${target} PUBLIC cxx_std_17)
  else()
    target_compile_features(${target} PUBLIC c_std_11)
    if(UNIX) # as properties: a project may call target_link_libraries for the target with keywords, or without
      set_property(TARGET ${target} APPEND PROPERTY LINK_LIBRARIES m)
      set_property(TARGET ${target} APPEND PROPERTY INTERFACE_LINK_LIBRARIES m)
    endif()
  endif()
endfunction()
