"""The units of Algorithm 1 under the names of the paper: FU, FTG, CWTG1, UBMG, CWTG2, FTA."""
