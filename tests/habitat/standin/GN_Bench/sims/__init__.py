from GN_Bench.sims._simulator import GNBenchSim


def make_sim(id_sim, config):
    assert id_sim == "Sim-v0", "Could not find simulator with name {}".format(id_sim)
    return GNBenchSim(config)
