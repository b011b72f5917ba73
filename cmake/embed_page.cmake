cmake_minimum_required(VERSION 3.25)
# cmake -DFOLDER=... -DOUT=... -P embed_page.cmake: a C++ source with the files of a folder. The assembler takes them as
# they are, so that megabytes compile in no time.
file(GLOB_RECURSE files RELATIVE ${FOLDER} ${FOLDER}/*)
list(SORT files)
if(NOT "index.html" IN_LIST files)
  message(FATAL_ERROR "${FOLDER} holds no index.html")
endif()
set(data "")
set(declarations "")
set(entries "")
set(number 0)
foreach(file ${files})
  string(APPEND data "    \".global nacre_page_${number}, nacre_page_${number}_end\\n\"\n"
                     "    \"nacre_page_${number}: .incbin \\\"${FOLDER}/${file}\\\"\\n\"\n"
                     "    \"nacre_page_${number}_end: .byte 0\\n\"\n")
  string(APPEND declarations "extern const char nacre_page_${number}[], nacre_page_${number}_end[];\n")
  set(path "/${file}")
  if(file STREQUAL "index.html")
    set(path "/")
  endif()
  string(APPEND entries "      {\"${path}\", {nacre_page_${number}, "
                        "std::size_t(nacre_page_${number}_end - nacre_page_${number})}},\n")
  # What the files hold is in the source, so that a new page is compiled anew.
  file(SHA256 ${FOLDER}/${file} hash)
  string(APPEND entries "      // ${hash}\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE ${OUT} "#include \"explorer/server.h\"

asm(\".pushsection .rodata\\n\"
${data}    \".popsection\\n\");

extern \"C\" {
${declarations}}

namespace nacre {

const std::vector<PageFile>& page_files() {
  static const std::vector<PageFile> files{
${entries}  };
  return files;
}

} // namespace nacre
")
