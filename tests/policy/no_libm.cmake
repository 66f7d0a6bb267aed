# Fails if the network calls a transcendental function of the mathematics library: its bits differ
# from system to system. The CONTROL, which calls some, shows that they would be seen.
function(transcendentals object result)
  execute_process(COMMAND ${NM} -u ${object} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL
         "U _*(a?sinh?|a?cosh?|sincos|a?tanh?|atan2|exp(2|m1|10)?|log(2|1p|10)?|pow|cbrt|hypot|erfc?|[tl]gamma)f?[\n@]"
         found "${symbols}")
  set(${result} "${found}" PARENT_SCOPE)
endfunction()

transcendentals(${CONTROL} seen)
if(NOT seen)
  message(FATAL_ERROR "${CONTROL} calls no transcendental function, expected exp and tanh")
endif()
transcendentals(${OBJECT} calls)
if(calls)
  message(FATAL_ERROR "${OBJECT} calls ${calls}")
endif()
