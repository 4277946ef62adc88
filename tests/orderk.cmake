hydrotin_test(orderk_test SOURCES orderk_test.cpp DEPENDS orderk)
hydrotin_test(lemma_2_1_test SOURCES lemma_2_1_test.cpp DEPENDS orderk)
hydrotin_test(orders_test SOURCES orders_test.cpp DEPENDS orderk)
