# Writes OUTPUT, a C++ source that holds the files named in NETWORKS, so that nothing has to be found at run time.
# cmake -DNETWORKS=a.onnx;b.onnx -DOUTPUT=file.cpp -P embed_networks.cmake
set(text "#include \"contact_nn/embedded_networks.h\"\n\nnamespace quayside::contact_nn {\n")
foreach(network IN LISTS NETWORKS)
  get_filename_component(name "${network}" NAME_WE)
  file(READ "${network}" bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(APPEND text "\nstatic const unsigned char ${name}[] = {${bytes}};\n"
                     "std::string_view embedded_${name}() {\n"
                     "  return {reinterpret_cast<const char*>(${name}), sizeof ${name}};\n}\n")
endforeach()
string(APPEND text "\n}  // namespace quayside::contact_nn\n")
file(WRITE "${OUTPUT}" "${text}")
