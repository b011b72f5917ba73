# nacre_page(OUT): a source that holds the explorer's page. With node and npm it is built from web/ by the versions that
# web/package-lock.json names; else a page that says that it is missing takes its place.
option(NACRE_PAGE "Build the explorer's page with npm, if it is there" ON)

function(nacre_page out)
  set(web ${PROJECT_SOURCE_DIR}/web)
  set(source ${PROJECT_BINARY_DIR}/page/page_files.cpp)
  find_program(NACRE_NODE node)
  find_program(NACRE_NPM npm)
  set(embed ${PROJECT_SOURCE_DIR}/cmake/embed_page.cmake)
  if(NACRE_PAGE AND NACRE_NODE AND NACRE_NPM AND EXISTS ${web}/package-lock.json AND EXISTS ${web}/index.html)
    file(GLOB_RECURSE parts CONFIGURE_DEPENDS ${web}/src/*)
    set(modules ${web}/node_modules/.package-lock.json)
    add_custom_command(
      OUTPUT ${modules} DEPENDS ${web}/package-lock.json ${web}/package.json
      COMMAND ${NACRE_NPM} ci --no-audit --no-fund --loglevel=error
      COMMAND ${CMAKE_COMMAND} -E touch ${modules}
      WORKING_DIRECTORY ${web} COMMENT "Fetching what the explorer's page is built with" VERBATIM)
    add_custom_command(
      OUTPUT ${source} DEPENDS ${modules} ${parts} ${web}/index.html ${web}/build.mjs ${embed}
      COMMAND ${NACRE_NPM} run --silent build
      COMMAND ${CMAKE_COMMAND} -DFOLDER=${web}/dist -DOUT=${source} -P ${embed}
      WORKING_DIRECTORY ${web} COMMENT "Building the explorer's page" VERBATIM)
  else()
    set(page ${PROJECT_SOURCE_DIR}/cmake/no_page)
    if(NACRE_PAGE)
      message(STATUS "The explorer's page is not built: it needs node, npm and web/")
    endif()
    add_custom_command(
      OUTPUT ${source} DEPENDS ${page}/index.html ${embed}
      COMMAND ${CMAKE_COMMAND} -DFOLDER=${page} -DOUT=${source} -P ${embed} VERBATIM)
  endif()
  set_source_files_properties(${source} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
  set(${out} ${source} PARENT_SCOPE)
endfunction()
