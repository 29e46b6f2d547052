//! The optimiser process, spoken to over iceoryx2.
