# Fails if a library has instructions that g++ 12 makes of products and alternating sums, despite
# -ffp-contract=off: its bits then differ from those of clang. The CONTROL, which asks for fused
# multiply-adds, shows that they would be seen.
function(count_instructions library pattern result)
  execute_process(COMMAND ${OBJDUMP} -d --no-show-raw-insn ${library} OUTPUT_VARIABLE code COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "${pattern}" found "${code}")
  list(LENGTH found number)
  set(${result} ${number} PARENT_SCOPE)
endfunction()

count_instructions(${CONTROL} "vfmadd" seen)
if(seen EQUAL 0)
  message(FATAL_ERROR "${CONTROL} has no fused multiply-add, expected some")
endif()
foreach(library IN LISTS LIBRARIES)
  count_instructions(${library} "vfm(addsub|subadd)" fused)
  if(NOT fused EQUAL 0)
    message(FATAL_ERROR "${library} has ${fused} fused multiply-add-subtracts, expected none: "
                        "-fno-tree-slp-vectorize, as rt/core/CMakeLists.txt has it")
  endif()
endforeach()
