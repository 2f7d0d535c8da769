# Runs COMMAND, which must end with 0 and print what matches OUTPUT.
execute_process(COMMAND ${COMMAND} RESULT_VARIABLE code OUTPUT_VARIABLE printed
  ERROR_VARIABLE complaints)
if(NOT code EQUAL 0 OR NOT printed MATCHES "${OUTPUT}")
  message(FATAL_ERROR "ended with ${code}; printed:\n${printed}${complaints}\nexpected: ${OUTPUT}")
endif()
