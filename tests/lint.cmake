# What reads the sources instead of running them: format, clang-tidy, and spirv-val of every shader.
find_program(CLANG_FORMAT clang-format-19)
find_program(RUN_CLANG_TIDY run-clang-tidy-19)
find_program(SPIRV_VAL spirv-val)
find_program(PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)

if(CLANG_FORMAT)
    add_test(NAME clang_format WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} COMMAND sh -c
        "find apps bench examples include scripts src tests -name '*.cpp' -o -name '*.h' | xargs ${CLANG_FORMAT} --dry-run --Werror")
    set_tests_properties(clang_format PROPERTIES LABELS quick)
endif()

if(RUN_CLANG_TIDY)
    add_test(NAME clang_tidy WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
        COMMAND ${RUN_CLANG_TIDY} -quiet -extra-arg=-Wno-unknown-warning-option -p ${CMAKE_BINARY_DIR} -j 2
                "${PROJECT_SOURCE_DIR}/(src|apps|bench|examples)/")
    set_tests_properties(clang_tidy PROPERTIES LABELS full TIMEOUT 900 PROCESSORS 2)
endif()

if(SPIRV_VAL AND PYTHON)
    add_test(NAME spirv_val COMMAND ${PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/lint/spirv_val.py
        ${SPIRV_VAL} ${PROJECT_BINARY_DIR}/spirv)
    set_tests_properties(spirv_val PROPERTIES LABELS quick)
endif()
