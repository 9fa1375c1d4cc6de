# Writes OUTPUT, a C++ source that holds the page with its style and scripts in place, so that nothing has to be found at
# run time. cmake -DFOLDER=page -DSCRIPTS=a.js;b.js -DOUTPUT=file.cpp -P embed_page.cmake
file(READ ${FOLDER}/page.html page)
file(READ ${FOLDER}/page.css style)
set(script "")
foreach(name IN LISTS SCRIPTS)
  file(READ ${FOLDER}/${name} text)
  string(APPEND script "${text}")
endforeach()
string(REPLACE "{{style}}" "${style}" page "${page}")
string(REPLACE "{{script}}" "${script}" page "${page}")
file(WRITE ${OUTPUT}.html "${page}")
file(READ ${OUTPUT}.html bytes HEX)
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
file(WRITE ${OUTPUT} "#include <string_view>\n\nnamespace quayside::harness::report {\n\n"
  "static const unsigned char text[] = {${bytes}};\n"
  "std::string_view page_template() { return {reinterpret_cast<const char*>(text), sizeof text}; }\n\n"
  "}  // namespace quayside::harness::report\n")
