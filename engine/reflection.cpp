#include "engine/reflection.h"

#include <spirv_cross/spirv_cross_c.h>

#include <algorithm>
#include <memory>

#include "engine/error.h"

namespace rosefusion {
namespace {

void require(spvc_result result, const ShaderCode& code) {
  if (result != SPVC_SUCCESS)
    throw DeviceError(DeviceErrorCode::Programming,
                      "The embedded shader " + std::string(code.name) + " cannot be parsed.");
}

ShaderStruct structOf(spvc_compiler compiler, spvc_type type, const ShaderCode& code) {
  ShaderStruct out;
  const spvc_type_id base = spvc_type_get_base_type_id(type);
  out.name = spvc_compiler_get_name(compiler, base);
  std::size_t bytes = 0;
  require(spvc_compiler_get_declared_struct_size(compiler, type, &bytes), code);
  out.bytes = static_cast<std::uint32_t>(bytes);
  for (unsigned m = 0; m < spvc_type_get_num_member_types(type); ++m) {
    unsigned offset = 0;
    require(spvc_compiler_type_struct_member_offset(compiler, type, m, &offset), code);
    out.members.push_back({spvc_compiler_get_member_name(compiler, base, m), offset});
  }
  return out;
}

}  // namespace

ShaderInterface reflect(const ShaderCode& code) {
  spvc_context context = nullptr;
  require(spvc_context_create(&context), code);
  const std::unique_ptr<spvc_context_s, void (*)(spvc_context)> owner(context, spvc_context_destroy);
  spvc_parsed_ir ir = nullptr;
  spvc_compiler compiler = nullptr;
  spvc_resources resources = nullptr;
  require(spvc_context_parse_spirv(context, code.words.data(), code.words.size(), &ir), code);
  require(spvc_context_create_compiler(context, SPVC_BACKEND_NONE, ir, SPVC_CAPTURE_MODE_TAKE_OWNERSHIP,
                                       &compiler),
          code);
  require(spvc_compiler_create_shader_resources(compiler, &resources), code);

  ShaderInterface out;
  const spvc_reflected_resource* list = nullptr;
  std::size_t count = 0;
  for (const auto& [type, kind] : {std::pair(SPVC_RESOURCE_TYPE_STORAGE_BUFFER, BindingKind::Storage),
                                   std::pair(SPVC_RESOURCE_TYPE_UNIFORM_BUFFER, BindingKind::Uniform)}) {
    require(spvc_resources_get_resource_list_for_type(resources, type, &list, &count), code);
    for (std::size_t i = 0; i < count; ++i) {
      out.bindings.push_back(
          {spvc_compiler_get_decoration(compiler, list[i].id, SpvDecorationBinding), kind});
      const spvc_type block = spvc_compiler_get_type_handle(compiler, list[i].base_type_id);
      for (unsigned m = 0; m < spvc_type_get_num_member_types(block); ++m) {
        // Without its array dimensions: what is compared is one element.
        const spvc_type member = spvc_compiler_get_type_handle(compiler, spvc_type_get_member_type(block, m));
        if (spvc_type_get_basetype(member) != SPVC_BASETYPE_STRUCT) continue;
        const spvc_type element = spvc_compiler_get_type_handle(compiler, spvc_type_get_base_type_id(member));
        const ShaderStruct found = structOf(compiler, element, code);
        if (std::none_of(out.structs.begin(), out.structs.end(),
                         [&](const ShaderStruct& s) { return s.name == found.name; }))
          out.structs.push_back(found);
      }
    }
  }
  require(
      spvc_resources_get_resource_list_for_type(resources, SPVC_RESOURCE_TYPE_SEPARATE_IMAGE, &list, &count),
      code);
  for (std::size_t i = 0; i < count; ++i) {
    const spvc_type image = spvc_compiler_get_type_handle(compiler, list[i].base_type_id);
    const spvc_type texel = spvc_compiler_get_type_handle(compiler, spvc_type_get_image_sampled_type(image));
    out.bindings.push_back({spvc_compiler_get_decoration(compiler, list[i].id, SpvDecorationBinding),
                            spvc_type_get_basetype(texel) == SPVC_BASETYPE_FP32 ? BindingKind::VectorTexels
                                                                                : BindingKind::WordTexels});
  }
  std::sort(out.bindings.begin(), out.bindings.end(),
            [](const ShaderBinding& a, const ShaderBinding& b) { return a.number < b.number; });

  require(
      spvc_resources_get_resource_list_for_type(resources, SPVC_RESOURCE_TYPE_PUSH_CONSTANT, &list, &count),
      code);
  if (count > 0) {
    const spvc_type block = spvc_compiler_get_type_handle(compiler, list[0].base_type_id);
    // The block holds one struct (`Params params`), whose members are what the interface header declares.
    out.push = structOf(compiler,
                        spvc_compiler_get_type_handle(compiler, spvc_type_get_member_type(block, 0)), code);
  }
  for (unsigned axis = 0; axis < 3; ++axis)
    out.workgroup[axis] =
        spvc_compiler_get_execution_mode_argument_by_index(compiler, SpvExecutionModeLocalSize, axis);
  return out;
}

}  // namespace rosefusion
