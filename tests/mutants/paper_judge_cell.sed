# what: pairs are tested in every cell they share
# file: kernels/multi_cell_paper.cu
# build: address
# detector: multi_cell_bucket_paper
s/kAblation == Ablation::judge_off ||/true ||/
