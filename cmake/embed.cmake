# Files that the program carries as texts: of data, `palpate_embed(page page_style page/style.css ...)` has
# palpate::data::page_style() return what is in page/style.css, as it is. Whoever calls it declares it.
# After palpate_folder(page ...). The build runs this file as a script, with the same words.
function(palpate_embed folder)
    get_filename_component(room ${CMAKE_CURRENT_SOURCE_DIR} NAME)
    list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ REGEX "/" OUTPUT_VARIABLE words)
    list(FILTER ARGN INCLUDE REGEX "/")
    set(output ${CMAKE_CURRENT_BINARY_DIR}/${folder}_texts.cpp)
    add_custom_command(
        OUTPUT ${output}
        COMMAND ${CMAKE_COMMAND} -DROOM=${room} -DOUTPUT=${output} "-DWORDS=${words}"
                -P ${PROJECT_SOURCE_DIR}/cmake/embed.cmake
        DEPENDS ${ARGN} ${PROJECT_SOURCE_DIR}/cmake/embed.cmake
        VERBATIM)
    target_sources(palpate_${room}_${folder} PRIVATE ${output})
endfunction()

if(CMAKE_SCRIPT_MODE_FILE)
    set(code "#include <string_view>\n\nnamespace palpate::${ROOM} {\n")
    while(WORDS)
        list(POP_FRONT WORDS name file)
        file(READ "${file}" text)
        string(APPEND code "\nstd::string_view ${name}();\nstd::string_view ${name}() {\n"
            "    return R\"palpate_text(${text})palpate_text\";\n}\n")
    endwhile()
    file(WRITE "${OUTPUT}" "${code}\n}  // namespace palpate::${ROOM}\n")
endif()
